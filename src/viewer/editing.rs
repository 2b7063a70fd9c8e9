//! Edits beside the window: a thread makes them one after the other, and the window goes on.

use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::city::{Edit, EditReport, Editor};

/// What to do.
#[derive(Clone, Debug)]
pub enum EditCommand {
    /// An edit.
    Apply(Edit),
    /// Take the last one back.
    Undo,
    /// Make it again.
    Redo,
    /// Take over what another program wrote into the footprint dataset.
    TakeOver,
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
    /// None once it is closed.
    commands: Option<Sender<EditCommand>>,
    thread: Option<JoinHandle<()>>,
    outcomes: Receiver<EditOutcome>,
    /// Commands without an outcome yet.
    pending: usize,
    /// Edits that can be taken back, and made again.
    pub depth: [usize; 2],
}

/// The thread looks after its copy of the dataset so often, and so soon after a command, or after so many times what the last copy took.
const IDLE: Duration = Duration::from_millis(1500);
const SOON: Duration = Duration::from_millis(200);
const COPIES: u32 = 4;

impl Editing {
    /// For a city.
    pub fn new(city: &Path) -> Self {
        let (commands, queue) = channel::<EditCommand>();
        let (answers, outcomes) = channel();
        let scratch = std::env::temp_dir().join(format!("rilievo-edits-{}", std::process::id()));
        let mut editor = Editor::new(city, scratch);
        let thread = std::thread::spawn(move || {
            let (mut wait, mut copied) = (IDLE, Duration::ZERO);
            loop {
                match queue.recv_timeout(wait) {
                    Ok(command) => {
                        wait = SOON.max(COPIES * copied).min(IDLE);
                        if answers.send(outcome_of(&mut editor, &command)).is_err() {
                            break;
                        }
                    }
                    // Without the copy edits of others only take longer.
                    Err(RecvTimeoutError::Timeout) => {
                        let begun = Instant::now();
                        if let Ok(true) = editor.keep_known() {
                            copied = begun.elapsed();
                        }
                        wait = IDLE;
                    }
                    Err(RecvTimeoutError::Disconnected) => break,
                }
            }
        });
        Self {
            commands: Some(commands),
            thread: Some(thread),
            outcomes,
            pending: 0,
            depth: [0; 2],
        }
    }

    /// Has a command done.
    pub fn send(&mut self, command: EditCommand) {
        let sent = self.commands.as_ref().map(|commands| commands.send(command));
        if matches!(sent, Some(Ok(()))) {
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

impl Drop for Editing {
    /// The edit in hand is finished, and the thread's files are removed.
    fn drop(&mut self) {
        self.commands = None;
        if let Some(thread) = self.thread.take() {
            // What it came to was told already.
            let _ = thread.join();
        }
    }
}

/// Does a command.
fn outcome_of(editor: &mut Editor, command: &EditCommand) -> EditOutcome {
    let done = match command {
        EditCommand::Apply(edit) => editor.apply(edit).map(|report| told(&report, name_of(edit))),
        EditCommand::Undo => editor.undo().map(|report| undone(report.as_ref(), "as before")),
        EditCommand::Redo => editor.redo().map(|report| undone(report.as_ref(), "as after")),
        EditCommand::TakeOver => editor.take_over().map(|report| {
            let tiles = report.written + report.removed;
            (format!("the dataset was edited: {tiles} tiles changed"), None)
        }),
    };
    let (text, building) = done.unwrap_or_else(|error| (error.to_string(), None));
    EditOutcome {
        text,
        building,
        depth: editor.depth(),
    }
}

/// What is said of an edit, and the building that it was about.
type Told = (String, Option<(u32, bool)>);

fn told(report: &EditReport, what: &str) -> Told {
    let text = format!("building {} {what}", report.fid);
    (text, Some((report.fid, report.is_standing)))
}

fn undone(report: Option<&EditReport>, what: &str) -> Told {
    report.map_or_else(
        || ("nothing to take back or to make again".to_owned(), None),
        |report| told(report, what),
    )
}

fn name_of(edit: &Edit) -> &'static str {
    match edit {
        Edit::Add { .. } => "drawn",
        Edit::Delete { .. } => "deleted",
        Edit::Outline { .. } | Edit::Height { .. } => "changed",
    }
}
