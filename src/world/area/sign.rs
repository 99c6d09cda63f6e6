//! How drawings and meshes say which template something is of.

/// What a template is called in drawings and meshes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sign {
    /// The template's name.
    pub name: String,
    /// Its key, where it has one.
    pub key: Option<char>,
    /// Its colour, where it has one: red, green, blue.
    pub colour: Option<[u8; 3]>,
}

/// What something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// Ground of a template.
    Template(usize),
    /// Nothing to walk on, and nothing to walk through.
    Blocked,
}

/// The word for what nobody can walk on or through.
const BLOCKED: &str = "blocked";

impl Sign {
    fn is(&self, word: &str) -> bool {
        let mut letters = word.chars();
        self.name == word || (self.key.is_some() && letters.next() == self.key && letters.next().is_none())
    }
}

/// What a word means: a template's name or key or `blocked`, perhaps with a number behind it, as programs for drawing add them
/// (`lane.001`, `lane-2`).
pub(super) fn meaning(word: &str, signs: &[Sign]) -> Option<Meaning> {
    let plain = |word: &str| {
        let template = signs.iter().position(|sign| sign.is(word)).map(Meaning::Template);
        template.or((word == BLOCKED).then_some(Meaning::Blocked))
    };
    let short = word.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches([' ', '.', '-', '_']);
    plain(word).or_else(|| plain(short))
}
