//! Opens every kind of report in a headless Chromium: no message on the console, nothing asked from elsewhere, every figure
//! drawn. Screenshots go to the target folder. Without Chromium the tests say so and pass.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use crate::guide::TURNS;
use crate::support::Done;

/// The browser, where there is one.
fn chromium() -> Option<&'static str> {
    let works = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    let found = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(works);
    if found.is_none() {
        println!("skipped: there is no Chromium on this machine (Debian: apt-get install chromium)");
    }
    found
}

/// A browser that takes longer hangs: a page takes it a few seconds.
const PATIENCE: Duration = Duration::from_secs(180);

/// What the browser made of a page.
struct Opened {
    document: String,
    console: Vec<String>,
}

/// Opens a page; `more` are arguments such as what is to be written where.
fn open(browser: &str, page: &Path, more: &[String]) -> Result<Opened, Box<dyn Error>> {
    let profile = tempfile::tempdir()?;
    let (document, said) = (profile.path().join("document"), profile.path().join("said"));
    let mut child = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .args(["--virtual-time-budget=8000", "--enable-logging=stderr", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(more)
        .arg(format!("file://{}", page.canonicalize()?.display()))
        .stdout(fs::File::create(&document)?)
        .stderr(fs::File::create(&said)?)
        .spawn()?;
    let started = Instant::now();
    while child.try_wait()?.is_none() {
        if started.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Err(format!("{} kept the browser busy for {PATIENCE:?}", page.display()).into());
        }
        thread::sleep(Duration::from_millis(20));
    }
    let read = |path: &Path| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    Ok(Opened {
        document: read(&document)?,
        console: read(&said)?.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect(),
    })
}

fn sinscal(arguments: &[&str]) -> Done {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).output()?;
    if output.status.success() {
        return Ok(());
    }
    Err(format!("{arguments:?}: {}", String::from_utf8_lossy(&output.stderr)).into())
}

/// Where screenshots go.
fn shots() -> Result<PathBuf, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reports");
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// Opens a report and checks it; `sections` are words of headings that must be there.
fn check(browser: &str, name: &str, page: &Path, sections: &[&str]) -> Done {
    let shot = shots()?.join(format!("{name}.png"));
    // a picture left from another run must not stand for this one
    let _ = fs::remove_file(&shot);
    let more = ["--window-size=1280,4000".into(), format!("--screenshot={}", shot.display())];
    let opened = open(browser, page, &more)?;
    assert!(opened.console.is_empty(), "{name}: {:#?}", opened.console);
    let figures = opened.document.matches("data-figure=").count();
    assert!(
        opened.document.contains(&format!("data-drawn=\"{figures}\"")),
        "{name}: not all {figures} figures drawn"
    );
    assert_eq!(opened.document.matches("<canvas").count(), figures, "{name}");
    for section in sections.iter().chain(&["Where this comes from", "verdict", "sinscal 0."]) {
        assert!(opened.document.contains(section), "{name}: {section} is missing");
    }
    // the script and the library are in the page; nothing in it has an address elsewhere
    for address in ["src=\"", "href=\"http", "url(http", "<iframe", "<object"] {
        assert!(!opened.document.contains(address), "{name}: {address}");
    }
    let size = fs::metadata(&shot).map(|file| file.len())?;
    assert!(size > 20_000, "{name}: a screenshot of {size} bytes");
    Ok(())
}

/// A picture of a page as wide as a phone, which a window cannot be: in a frame, which says whether the page is wider than it.
fn framed(browser: &str, kind: &str, page: &Path, width: u32) -> Done {
    let folder = page.parent().ok_or("a page in a folder")?;
    let frame = folder.join(format!("frame-{width}.html"));
    let measured = "document.title = 'wide ' + f.contentDocument.documentElement.scrollWidth";
    fs::write(
        &frame,
        format!(
            "<body style=margin:0><iframe id=f src=report.html style='border:0;width:{width}px;height:3000px' \
             onload=\"{measured}\"></iframe>"
        ),
    )?;
    let shot = shots()?.join(format!("{kind}-{width}.png"));
    let more = [
        "--window-size=820,3000".into(),
        "--allow-file-access-from-files".into(),
        format!("--screenshot={}", shot.display()),
    ];
    let opened = open(browser, &frame, &more)?;
    assert!(opened.console.is_empty(), "{kind} at {width}: {:#?}", opened.console);
    assert!(
        opened.document.contains(&format!("<title>wide {width}</title>")),
        "{kind} is wider than {width}"
    );
    Ok(())
}

#[test]
fn the_browser_would_complain() -> Done {
    let Some(browser) = chromium() else { return Ok(()) };
    let folder = tempfile::tempdir()?;
    let page = folder.path().join("page.html");
    for (body, word) in [
        ("<script>nothingOfThisName()</script>", "nothingOfThisName"),
        ("<img src=\"http://127.0.0.1:9/x.png\">", "127.0.0.1"),
    ] {
        let policy = "default-src 'none'; script-src 'unsafe-inline'";
        fs::write(
            &page,
            format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">{body}"),
        )?;
        let console = open(browser, &page, &[])?.console.join("\n");
        assert!(console.contains(word), "{body}: {console}");
    }
    Ok(())
}

#[test]
fn reports_of_logs() -> Done {
    let Some(browser) = chromium() else { return Ok(()) };
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(folder.path().join("scenario.toml"), TURNS)?;
    let (log, scenario) = (at("log"), at("scenario.toml"));
    let page = |name: &str| folder.path().join(name).join("report.html");

    sinscal(&["simulate", "--scenario", &scenario, "--out", &log])?;
    check(browser, "simulate", &folder.path().join("log.html"), &["The true unit", "Angular rate"])?;
    sinscal(&["calibrate", &log, "--filter", "43d-b", "--out", &at("calibrate")])?;
    check(
        browser,
        "calibrate",
        &page("calibrate"),
        &["Numbers", "Convergence", "Residuals", "put through", "truth"],
    )?;
    sinscal(&["observe", &log, "--filter", "43d-b", "--out", &at("observe")])?;
    check(browser, "observe", &page("observe"), &["Degrees of observability", "Singular values"])?;
    sinscal(&["diagnose", &log, "--filter", "36d-p", "--out", &at("diagnose")])?;
    check(browser, "diagnose", &page("diagnose"), &["Rivals", "Remarks"])?;
    let calibration = at("calibrate/calibration.json");
    sinscal(&["navigate", &log, "--calibration", &calibration, "--align", "30", "--out", &at("navigate")])?;
    check(browser, "navigate", &page("navigate"), &["Horizontal error"])?;
    sinscal(&["ablate", &log, "--swing", &log, "--align", "30", "--out", &at("ablate")])?;
    check(browser, "ablate", &page("ablate"), &["Side by side", "Horizontal error"])?;

    sinscal(&["compare", &calibration, &calibration, "--out", &at("compare")])?;
    check(browser, "compare", &page("compare"), &["Differences", "Before differences are read", "Numbers"])?;
    let certificate = at("certificate.html");
    sinscal(&["export", &calibration, "--format", "certificate", "--out", &certificate])?;
    check(browser, "certificate", Path::new(&certificate), &["Values", "Conditions", "Approved by"])?;

    // every kind between a phone and a wide screen; what is wider than the page is moved aside within it
    for kind in ["calibrate", "observe", "diagnose", "navigate", "ablate", "compare"] {
        for width in [390, 820] {
            framed(browser, kind, &page(kind), width)?;
        }
    }

    // in the dark, on paper
    let report = page("calibrate");
    let shot = format!("--screenshot={}", shots()?.join("calibrate-dark.png").display());
    let dark = "--blink-settings=preferredColorScheme=0";
    let console = open(browser, &report, &[dark.into(), shot])?.console;
    assert!(console.is_empty(), "dark: {console:#?}");
    let pdf = shots()?.join("calibrate.pdf");
    let console = open(browser, &report, &[format!("--print-to-pdf={}", pdf.display())])?.console;
    assert!(console.is_empty(), "print: {console:#?}");
    let printed = fs::read(&pdf)?;
    let count = |what: &[u8]| printed.windows(what.len()).filter(|bytes| *bytes == what).count();
    let pages = count(b"/Type /Page") - count(b"/Type /Pages");
    assert!((1..=8).contains(&pages), "a calibration on {pages} pages");
    Ok(())
}

#[test]
fn reports_of_many_units() -> Done {
    let Some(browser) = chromium() else { return Ok(()) };
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(folder.path().join("scenario.toml"), TURNS)?;
    let scenario = at("scenario.toml");
    let page = |name: &str| folder.path().join(name).join("report.html");
    let short = ["--scenario", &scenario, "--units", "2", "--hours", "0.1"];

    sinscal(&[&["campaign", "--align", "60", "--out", &at("campaign")][..], &short].concat())?;
    check(browser, "campaign", &page("campaign"), &["Navigation", "Consistency", "Parameters of 43d-b"])?;
    sinscal(&[&["paper", "--out", &at("paper")][..], &short].concat())?;
    check(browser, "paper", &page("paper"), &["Table 3", "Figs. 4 and 5", "Figs. 7 to 14", "Fig. 3"])
}

/// A whole demonstration, for each of two effects: a minute or two each in a debug build.
#[test]
#[ignore = "runs whole demonstrations: minutes"]
fn reports_of_demonstrations() -> Done {
    let Some(browser) = chromium() else { return Ok(()) };
    for hide in ["accel-delay", "dither-size-effect"] {
        let folder = tempfile::tempdir()?;
        let out = folder.path().display().to_string();
        sinscal(&["demo", "--hide", hide, "--out", &out])?;
        let page = folder.path().join("report.html");
        let sections =
            ["What happened", "Against the truth", "Before and after", "Where it shows", "Residuals after"];
        check(browser, &format!("demo-{hide}"), &page, &sections)?;
    }
    Ok(())
}
