//! Edits beside the window: a thread makes them one after the other, and the window goes on.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

use crate::city::{CityError, Edit, EditReport, Editor};

/// What to do.
#[derive(Clone, Debug)]
pub enum EditCommand {
    /// An edit.
    Apply(Edit),
    /// Take the last one back.
    Undo,
    /// Make it again.
    Redo,
}

/// What came of a command.
#[derive(Clone, Debug)]
pub struct EditOutcome {
    /// A line that tells it.
    pub text: String,
    /// The building that it was about, and whether it stands now.
    pub building: Option<(u32, bool)>,
    /// Edits that can be taken back, and made again.
    pub depth: [usize; 2],
}

/// The thread, and what is under way.
pub struct Editing {
    commands: Sender<EditCommand>,
    outcomes: Receiver<EditOutcome>,
    /// Commands without an outcome yet.
    pending: usize,
    /// Edits that can be taken back, and made again.
    pub depth: [usize; 2],
}

impl Editing {
    /// For a city.
    pub fn new(city: &Path) -> Self {
        let (commands, queue) = channel::<EditCommand>();
        let (answers, outcomes) = channel();
        let scratch = std::env::temp_dir().join(format!("rilievo-edits-{}", std::process::id()));
        let mut editor = Editor::new(city, scratch);
        std::thread::spawn(move || {
            for command in queue {
                let result = match &command {
                    EditCommand::Apply(edit) => editor.apply(edit).map(Some),
                    EditCommand::Undo => editor.undo(),
                    EditCommand::Redo => editor.redo(),
                };
                let outcome = outcome(&command, result, editor.depth());
                if answers.send(outcome).is_err() {
                    break;
                }
            }
        });
        Self {
            commands,
            outcomes,
            pending: 0,
            depth: [0; 2],
        }
    }

    /// Has a command done.
    pub fn send(&mut self, command: EditCommand) {
        if self.commands.send(command).is_ok() {
            self.pending += 1;
        }
    }

    /// Whether something is under way.
    pub fn is_busy(&self) -> bool {
        self.pending > 0
    }

    /// What came of a command, once each.
    pub fn take(&mut self) -> Option<EditOutcome> {
        let outcome = self.outcomes.try_recv().ok()?;
        self.pending = self.pending.saturating_sub(1);
        self.depth = outcome.depth;
        Some(outcome)
    }
}

fn outcome(
    command: &EditCommand,
    result: Result<Option<EditReport>, CityError>,
    depth: [usize; 2],
) -> EditOutcome {
    let (text, building) = match result {
        Ok(Some(report)) => {
            let what = match command {
                EditCommand::Apply(Edit::Add { .. }) => "drawn",
                EditCommand::Apply(Edit::Delete { .. }) => "deleted",
                EditCommand::Apply(Edit::Outline { .. } | Edit::Height { .. }) => "changed",
                EditCommand::Undo => "as before",
                EditCommand::Redo => "as after",
            };
            (
                format!("building {} {what}", report.fid),
                Some((report.fid, report.is_standing)),
            )
        }
        Ok(None) => ("nothing to take back or to make again".to_owned(), None),
        Err(error) => (error.to_string(), None),
    };
    EditOutcome {
        text,
        building,
        depth,
    }
}
