//! Labels of patches: what was measured, and the words of the capture's description.

use crate::motion::gait::Phase;
use crate::patch::episode::EventKind;

/// Words that say nothing.
const STOP_WORDS: [&str; 16] = [
    "and", "the", "with", "then", "from", "into", "onto", "over", "subject", "subjects", "for", "off", "out", "one",
    "two", "degree",
];

/// The word for what somebody does who just stands.
pub(super) const REST: &str = "idle";

/// The word for a kind of event.
pub(super) fn of_event(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Contact => "contact",
        EventKind::Proximity => "proximity",
        EventKind::Synchronicity => "synchronicity",
    }
}

/// Adds the words of a description: those of three letters or more, once each.
pub(super) fn add_words(labels: &mut Vec<String>, description: &str) {
    for word in description.split(|c: char| !c.is_alphabetic()) {
        let word = word.to_lowercase();
        if word.chars().count() >= 3 && !STOP_WORDS.contains(&word.as_str()) && !labels.contains(&word) {
            labels.push(word);
        }
    }
}

/// What somebody does between two ports: by their phases, whether the person turned, and whether more happened than
/// standing.
pub(super) fn of_motion(entry: Phase, exit: Phase, turned: bool, acts: bool) -> &'static str {
    match (entry == Phase::Stand, exit == Phase::Stand) {
        (true, true) if acts => "action",
        (true, true) if turned => "turn",
        (true, true) => REST,
        (true, false) => "start",
        (false, true) => "stop",
        _ if turned => "turn",
        _ => "walk",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_taken_once_and_empty_ones_left_out() {
        let mut labels = vec!["walk".to_owned()];
        add_words(&mut labels, "walk, shake hands (2 subjects - subject A), and Shake");
        assert_eq!(labels, ["walk", "shake", "hands"]);
    }
}
