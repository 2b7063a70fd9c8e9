//! Work that goes on beside the frames, one at a time, on a thread that leaves the processor time for them.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::scene::stand_back;

/// What is in the making, and what it is of.
pub struct BesideFrames<K, T> {
    job: Option<(K, Receiver<T>)>,
}

impl<K, T> Default for BesideFrames<K, T> {
    fn default() -> Self {
        Self { job: None }
    }
}

impl<K, T: Send + 'static> BesideFrames<K, T> {
    /// True while something is in the making.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// What was finished since it was asked last.
    pub fn finished(&mut self) -> Option<(K, T)> {
        let (_, receiver) = self.job.as_ref()?;
        match receiver.try_recv() {
            Ok(made) => self.job.take().map(|(of, _)| (of, made)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                self.job = None;
                None
            }
        }
    }

    /// Begins; what was in the making is forgotten.
    pub fn begin(&mut self, of: K, work: impl FnOnce() -> T + Send + 'static) {
        let (sender, receiver) = channel();
        // Nobody may be there any more to take it.
        let work = move || drop(sender.send(work()));
        // What is parallel in it stays on that thread.
        let alone = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .start_handler(|_| stand_back());
        match alone.build() {
            Ok(thread) => thread.spawn(work),
            // There are no more threads: at once.
            Err(_) => work(),
        }
        self.job = Some((of, receiver));
    }
}
