//! How many threads work runs on.

use crate::exit::{Exit, Failure};

/// Runs `work` on `threads` threads; as many as there are cores when it is not said.
pub fn on_threads<T: Send>(threads: Option<u32>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build();
    let pool = pool
        .map_err(|e| Failure::new(Exit::Unexpected, format!("{threads} threads cannot be started: {e}; give fewer")))?;
    Ok(pool.install(work))
}
