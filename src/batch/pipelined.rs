//! A producer beside a consumer on another thread, in bounded memory.

use std::sync::mpsc::sync_channel;
use std::thread;

use crate::error::{Error, Result};

/// Things made and not yet taken.
const WAITING: usize = 1;

/// Makes things on this thread while `take` consumes them on another, in order; at most three exist
/// at a time: one being made, one waiting, one being consumed.
///
/// The first error of `make` is the last thing that `take` gets. When `take` ends, no more are
/// made.
///
/// # Errors
/// Those of `take`; the system starts no thread.
pub fn pipelined<T: Send, R: Send>(
    make: impl Iterator<Item = Result<T>>,
    take: impl FnOnce(&mut dyn Iterator<Item = Result<T>>) -> Result<R> + Send,
) -> Result<R> {
    thread::scope(|scope| {
        let (sender, receiver) = sync_channel(WAITING);
        let taker = thread::Builder::new()
            .spawn_scoped(scope, move || take(&mut receiver.into_iter()))
            .map_err(|cause| {
                Error::resource(format!("no thread can be started to write frames: {cause}"))
            })?;
        for made in make {
            let failed = made.is_err();
            if sender.send(made).is_err() || failed {
                break;
            }
        }
        drop(sender);
        taker
            .join()
            .unwrap_or_else(|_| Err(Error::failed("the thread that writes frames failed")))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn everything_arrives_in_order_and_little_is_waiting() {
        let (made, max_ahead) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let make = (0..50).map(|n| {
            made.fetch_add(1, Ordering::SeqCst);
            Ok(n)
        });
        let taken = pipelined(make, |things| {
            let mut taken = Vec::new();
            for thing in things {
                thread::yield_now();
                let ahead = made.load(Ordering::SeqCst) - taken.len();
                max_ahead.fetch_max(ahead, Ordering::SeqCst);
                taken.push(thing?);
            }
            Ok(taken)
        });
        assert_eq!(taken.unwrap(), (0..50).collect::<Vec<_>>());
        assert!(max_ahead.into_inner() <= WAITING + 2);
    }

    #[test]
    fn an_error_on_either_side_ends_both() {
        let mut made = 0;
        let failing = (0..).map(|n| {
            made += 1;
            if n == 3 {
                Err(Error::failed("no fourth"))
            } else {
                Ok(n)
            }
        });
        let mut taken = 0;
        let outcome = pipelined(failing, |things| {
            for thing in things {
                thing?;
                taken += 1;
            }
            Ok(())
        });
        assert_eq!(outcome.unwrap_err().to_string(), "no fourth");
        assert_eq!((made, taken), (4, 3));

        let mut made = 0;
        let endless = std::iter::repeat_with(|| {
            made += 1;
            Ok(())
        });
        let outcome: Result<()> = pipelined(endless, |things| {
            things.next();
            Err(Error::failed("the disk is full"))
        });
        assert_eq!(outcome.unwrap_err().to_string(), "the disk is full");
        assert!(made <= WAITING + 3, "{made}");
    }
}
