//! Being told to stop: files that are not whole yet are taken away first, then the program ends as it would have without.

use std::sync::atomic::{AtomicBool, Ordering};

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

/// Whether somebody would end on the first interrupt of their own accord, and whether there was one.
static WAITED_FOR: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// The first interrupt does not end the program as long as this lives: whoever holds it comes to an end with what there is. The next one
/// does.
pub(crate) struct FirstInterrupt(());

/// Waits for the first interrupt.
pub(crate) fn first_interrupt() -> FirstInterrupt {
    WAITED_FOR.store(true, Ordering::Relaxed);
    FirstInterrupt(())
}

impl FirstInterrupt {
    /// Whether there was one.
    pub(crate) fn asked(&self) -> bool {
        ASKED.load(Ordering::Relaxed)
    }
}

impl Drop for FirstInterrupt {
    fn drop(&mut self) {
        WAITED_FOR.store(false, Ordering::Relaxed);
    }
}

/// Begins to listen. What was ignored when the program was started, as `nohup` and shells do for what runs in the background, stays
/// ignored.
#[cfg(unix)]
pub(crate) fn listen() {
    let listening = || {
        let heard = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| !is_ignored(*signal));
        let Ok(mut signals) = signal_hook::iterator::Signals::new(heard) else { return };
        for signal in signals.forever() {
            if signal == SIGINT && WAITED_FOR.load(Ordering::Relaxed) && !ASKED.swap(true, Ordering::Relaxed)
            {
                continue;
            }
            let _nobody_writes = crate::output::abandon();
            // ends the program
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    };
    // Without the thread a signal ends the program at once, and the next one sweeps.
    let _ = std::thread::Builder::new().name("signals".into()).spawn(listening);
}

#[cfg(not(unix))]
pub(crate) fn listen() {}

/// Whether a signal was ignored from the beginning. Where the system does not tell, those that `nohup` and shells ignore are taken
/// for ignored: they end the program, or do not, without its doing.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    match mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()) {
        Some(mask) => mask & (1 << (signal - 1)) != 0,
        None => signal != SIGTERM,
    }
}
