//! Finds the effect that a calibration filter lacks.

mod candidates;
mod chi2;
mod dictionary;
mod linear;
mod name;
mod noise;
mod open;
mod prices;
mod random;
mod recording;
mod run;
mod scene;
mod threshold;
mod verify;

pub use candidates::{CandidateStates, Candidates};
pub use chi2::ln_survival;
pub use linear::Noise;
pub use recording::{Column, Recording};
pub use run::Log;


/// trial
#[doc(hidden)]
pub fn trial<F>(log: &Log, second: Option<&Log>)
where
    F: calib_core::Filter<Dynamics = sinscal::Strapdown>,
    calib_core::Extended<F, Candidates, CandidateStates>: calib_core::Filter<Dynamics = sinscal::Strapdown>,
{
    use scene::Scene;
    let t = std::time::Instant::now();
    let m = run::Declared::<F, Candidates, CandidateStates>::new();
    let s = match Scene::new(&m, log) { Ok(s) => s, Err(e) => { println!("{e:?}"); return; } };
    println!("scene passes {} {:?} nis {:.3} noise {:?}", s.ran.passes, t.elapsed(), s.ran.statistics.nis_per_dof(), s.noise);
    let among = s.excited();
    let th = threshold::simulate(&s.prices, &among, 0.005, 1, "library");
    println!("threshold {th} {:?}", t.elapsed());
    for g in s.prices.all() { let sc=s.prices.score(g); println!("   {:28} gain {:10.2} lnp {:10.2} ({}) exc {:.1?} all {:?}", s.prices.groups[g].name, s.prices.gain(&[g]), sc.ln_p, sc.directions, s.prices.excitation(g), s.prices.posterior(&[g]).unwrap().0.as_slice()); }
    let found = name::search(&s.prices, &among, th);
    println!("adequate {} exhaustive {} {:?}", found.adequate, found.exhaustive, t.elapsed());
    let second = second.map(|l| Scene::new(&m, l).map_err(|e| format!("{e:?}")).unwrap());
    for set in found.sets.iter().take(6) {
        println!("{:?} gain {:.1} left {:?}", set.groups.iter().map(|g| &s.prices.groups[*g].name).collect::<Vec<_>>(), set.gain, set.left.map(|(g, sc)| (&s.prices.groups[g].name, sc.ln_p)));
        println!("  held out {:?}", verify::held_out(&s, &set.groups));
        if let Some(second) = &second { println!("  noise2 {:?} verify {:?}", second.noise, verify::verify(&s, second, &set.groups, th)); }
        let post = s.prices.posterior(&set.groups).unwrap();
        println!("  est {:?}", post.0.iter().enumerate().map(|(i, v)| format!("{v:.3e}+-{:.1e}", post.1[(i, i)].sqrt())).collect::<Vec<_>>());
    }
    let open = open::Open::new(&s, 0.005, 1).unwrap();
    println!("dictionary {} families th {} {:?}", open.families, open.threshold, t.elapsed());
    let best = &found.sets[0].groups;
    for (g, sc) in open.loud(best).iter().take(5) { println!("  loud {} {:?} gain {:.1}", open.prices.groups[*g].name, sc.ln_p, open.gain_on(*g, best)); }
    for (g, sc) in open.loud(&[]).iter().take(3) { println!("  loud on base {} {:?} gain {:.1}", open.prices.groups[*g].name, sc.ln_p, open.gain_on(*g, &[])); }
    for g in open.rivals(best) { println!("  rival {}", open.prices.groups[g].name); }
    println!("{:?}", t.elapsed());
}
