//! Long work beside the window: a city in the making.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::Instant;

use crate::city::{CityError, ImportOptions, ImportProgress, ImportStage, import};
use crate::sample::write_sample;
use crate::source::HeightRule;

/// Work under way.
pub struct Job {
    what: String,
    begun: Instant,
    progress: ImportProgress,
    result: Receiver<Result<PathBuf, String>>,
}

impl Job {
    /// Imports a city.
    pub fn import(options: ImportOptions) -> Self {
        let what = format!("importing to {}", options.out.display());
        let progress = options.progress.clone();
        Self::run(what, progress, move || {
            import(&options).map(|_| options.out.clone())
        })
    }

    /// Makes the sample city in a folder, unless it is there.
    pub fn sample(folder: &Path) -> Self {
        let (files, out) = (folder.join("files"), folder.join("sample"));
        let progress = ImportProgress::default();
        let own = progress.clone();
        Self::run("making the sample city".to_owned(), progress, move || {
            if out.join("city.toml").is_file() {
                return Ok(out);
            }
            let files = write_sample(&files)?;
            let field = "height_m".to_owned();
            import(&ImportOptions {
                imagery: files.imagery,
                height_rule: Some(HeightRule::Height { field }),
                progress: own,
                ..ImportOptions::new(vec![files.terrain], files.buildings, out.clone())
            })?;
            Ok(out)
        })
    }

    fn run(
        what: String,
        progress: ImportProgress,
        work: impl FnOnce() -> Result<PathBuf, CityError> + Send + 'static,
    ) -> Self {
        let (sender, result) = channel();
        std::thread::spawn(move || {
            // Nobody waits for it any more when the window was closed.
            drop(sender.send(work().map_err(|error| error.to_string())));
        });
        Self {
            what,
            begun: Instant::now(),
            progress,
            result,
        }
    }

    /// What goes on, and for how long.
    pub fn text(&self) -> String {
        format!("{} … {:.0} s", self.what, self.begun.elapsed().as_secs_f64())
    }

    /// How far it is.
    pub fn stage(&self) -> Option<ImportStage> {
        self.progress.stage()
    }

    /// The city made, or why not; none while the work goes on.
    pub fn result(&self) -> Option<Result<PathBuf, String>> {
        self.result.try_recv().ok()
    }
}
