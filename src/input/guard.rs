//! The boundary to decoders: their panic over a stranger's file is an error of that file, like any other.
//!
//! A decoder runs on the thread that asks for the file, so what marks that thread marks all that may panic in it. The
//! programs end at any other panic (see `cli::run`), on whatever thread.

use super::error::InputError;
use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

thread_local! {
    static DECODES: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder over the content of `path`; its panic is [`InputError::Bad`].
///
/// # Errors
/// Those of `decode`, and its panic.
pub fn guarded<T, E: From<InputError>>(path: &Path, decode: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let outer = DECODES.replace(true);
    // What a decoder leaves half done goes away with it: it holds nothing that outlives the call.
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    DECODES.set(outer);
    decoded.unwrap_or_else(|panic| {
        let what = format!(
            "the decoder gave up on this file ({}); it is damaged or of a rare kind: export it again, maps as PNG, \
             environments as Radiance HDR, meshes as GLB",
            words(panic.as_ref())
        );
        Err(InputError::bad(path, what).into())
    })
}

/// Whether a panic on this thread is one that [`guarded`] turns into an error.
pub fn is_decoding() -> bool {
    DECODES.get()
}

/// What a panic said, on one line.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("without a reason").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fails(decode: impl FnOnce() -> u8) -> InputError {
        guarded(Path::new("a folder/odd.tif"), || Ok(decode())).unwrap_err()
    }

    #[test]
    fn a_panic_is_an_error_of_the_file() {
        let bytes: Vec<u8> = Vec::new();
        for error in [
            fails(|| bytes[std::hint::black_box(7)]),
            fails(|| panic!("text")),
            fails(|| None.expect("an\n option")),
            fails(|| std::panic::resume_unwind(Box::new(3))),
        ] {
            assert_eq!(error.exit_code(), 4);
            let message = error.to_string();
            assert!(
                message.starts_with("a folder/odd.tif: the decoder gave up") && !message.contains('\n'),
                "{message}"
            );
        }
        assert!(fails(|| panic!("seven {}", "words")).to_string().contains("(seven words)"));
    }

    #[test]
    fn only_panics_of_the_guarded_thread_are_the_decoders() {
        let path = Path::new("a.png");
        assert!(!is_decoding());
        let inside = guarded(path, || {
            let elsewhere = std::thread::spawn(is_decoding).join().unwrap();
            let nested = guarded(path, || Ok::<_, InputError>(is_decoding()))?;
            Ok::<_, InputError>((is_decoding(), nested, elsewhere))
        });
        assert_eq!(inside.unwrap(), (true, true, false));
        fails(|| panic!());
        assert!(!is_decoding());
    }
}
