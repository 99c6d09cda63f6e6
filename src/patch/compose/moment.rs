//! How a compose file speaks of moments and bodies: `ann.bow@0.2`, `ann.left_hand`.

use super::story::{Clip, Moment, Role, bad};
use super::text::LARGEST;
use crate::Result;
use crate::motion::BodyPart;

/// What moments may name.
pub(super) struct Names<'a> {
    pub roles: &'a [Role],
    pub clips: &'a [Clip],
}

impl Names<'_> {
    /// The role of a name.
    pub fn role(&self, name: &str, line: usize) -> Result<usize> {
        let found = self.roles.iter().position(|r| r.name == name);
        found.ok_or_else(|| bad(line, format!("expected the name of a role, found '{name}'")))
    }

    /// `role`, `role.clip`, `role@seconds`, `role.clip@seconds`.
    pub fn moment(&self, text: &str, line: usize) -> Result<Moment> {
        let (who, seconds) = match text.split_once('@') {
            Some((who, seconds)) => (who, Some(self.seconds(seconds, text, line)?)),
            None => (text, None),
        };
        let (name, clip) = who.split_once('.').map_or((who, None), |(name, clip)| (name, Some(clip)));
        let role = self.role(name, line)?;
        let part = clip.map(|clip| self.part(role, clip, line)).transpose()?;
        Ok(Moment { role, part, seconds, text: text.to_owned() })
    }

    fn seconds(&self, seconds: &str, whole: &str, line: usize) -> Result<f32> {
        let number = seconds.parse().ok().filter(|s| (0.0..=LARGEST).contains(s));
        number.ok_or_else(|| bad(line, format!("expected seconds after '@', found '{whole}'")))
    }

    /// Where in what the role plays a clip comes; it must come once.
    fn part(&self, role: usize, clip: &str, line: usize) -> Result<usize> {
        let Role { name, plays, .. } = &self.roles[role];
        let mut at = (0..plays.len()).filter(|&i| self.clips[plays[i]].name == clip);
        match (at.next(), at.next()) {
            (Some(part), None) => Ok(part),
            (None, _) => Err(bad(line, format!("expected a clip that {name} plays, found '{clip}'"))),
            (Some(_), Some(_)) => {
                let expected = format!("expected a clip that {name} plays once, found '{clip}', played more often");
                Err(bad(line, format!("{expected}; say when by '{name}@seconds'")))
            }
        }
    }

    /// `role.left_hand`, `role.right_hand`, `role.torso`, `role.head`.
    pub fn body_part(&self, text: &str, line: usize) -> Result<(usize, BodyPart)> {
        let (name, part) = text.split_once('.').unwrap_or((text, ""));
        let part = match part {
            "left_hand" => BodyPart::LeftHand,
            "right_hand" => BodyPart::RightHand,
            "torso" => BodyPart::Torso,
            "head" => BodyPart::Head,
            _ => {
                let expected = "expected a role's left_hand, right_hand, torso or head";
                return Err(bad(line, format!("{expected} ('ann.left_hand'), found '{text}'")));
            }
        };
        Ok((self.role(name, line)?, part))
    }
}
