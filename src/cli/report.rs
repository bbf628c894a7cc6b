//! Errors as text on standard error.

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use lixel::job::{JobError, Located};

use super::exit::Failure;

/// Says what went wrong and gives the exit code for it.
pub(super) fn failure(failure: &Failure) -> ExitCode {
    if !failure.is_silent() {
        match failure {
            Failure::Job(JobError::InFile(located), _) => quote(located),
            Failure::Job(JobError::Override(problem), flags) => {
                let flag = flags.iter().find(|(_, key)| problem.key.starts_with(key)).map(|f| f.0);
                let place = flag.unwrap_or(&problem.key);
                print(&format!("{place}: {}", problem.message), Some(&problem.help));
            }
            Failure::Job(error, _) => print(&error.to_string(), None),
            Failure::Plan(error) => print(&error.to_string(), None),
            Failure::Setup(message) | Failure::Input(message) => print(message, None),
            Failure::Stdout(error) => print(&format!("cannot write standard output: {error}"), None),
        }
    }
    failure.code()
}

/// A line on standard error. A closed standard error is no reason to fail.
pub(super) fn remark(quiet: bool, text: &str) {
    if !quiet {
        note(&format!("note: {text}"));
    }
}

/// One line on standard error.
pub(super) fn note(text: &str) {
    drop(writeln!(io::stderr(), "{text}"));
}

fn print(message: &str, help: Option<&str>) {
    note(&format!("error: {message}"));
    if let Some(help) = help {
        note(&format!("help: {help}"));
    }
}

/// The line of the job file, the place in it, and what to do.
fn quote(located: &Located) {
    let path = located.path.display().to_string();
    let snippet = Snippet::source(located.text.as_str())
        .path(path)
        .annotation(AnnotationKind::Primary.span(located.span.clone()));
    let mut group = Group::with_title(Level::ERROR.primary_title(located.message.as_str())).element(snippet);
    if let Some(help) = &located.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let plain = !io::stderr().is_terminal() || std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    let renderer = if plain { Renderer::plain() } else { Renderer::styled() };
    note(&renderer.render(&[group]));
}
