//! The text of a compose file (TOML): every problem names its line.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::Vec2;
use toml::Spanned;

use super::moment::Names;
use super::prop_text::PropText;
use super::row::{self, Row};
use super::story::{Clip, Composition, Piece, Place, Role, Touches, bad};
use crate::Result;
use crate::deform::Limits;
use crate::geom::Ground;
use crate::motion::{BodyPart, Foot};

/// Largest number of people, after rows are laid out.
pub(super) const MOST_PEOPLE: usize = 64;
/// Most clips that one plays.
const MOST_CLIPS: usize = 64;
/// Largest coordinate or time, metres or seconds.
pub(super) const LARGEST: f32 = 1e4;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    name: Spanned<String>,
    #[serde(default)]
    labels: Vec<String>,
    #[serde(default)]
    limits: Option<Spanned<String>>,
    clips: BTreeMap<String, Spanned<ClipText>>,
    roles: Vec<Spanned<RoleText>>,
    #[serde(default)]
    places: Vec<Spanned<PlaceText>>,
    #[serde(default)]
    touches: Vec<Spanned<TouchText>>,
    #[serde(default)]
    props: Vec<Spanned<PropText>>,
    #[serde(default)]
    row: Option<Spanned<RowText>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ClipText {
    take: Option<String>,
    person: Option<usize>,
    from: Option<f32>,
    to: Option<f32>,
    patch: Option<String>,
    role: Option<usize>,
    arms: Option<Foot>,
    #[serde(default)]
    mirror: bool,
    #[serde(default, rename = "loop")]
    looped: bool,
    end: Option<EndText>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct EndText {
    #[serde(default)]
    ahead: f32,
    #[serde(default)]
    left: f32,
    #[serde(default)]
    turn_deg: f32,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RoleText {
    name: String,
    plays: Vec<String>,
    start: Option<StartText>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct StartText {
    #[serde(default)]
    x: f32,
    #[serde(default)]
    z: f32,
    #[serde(default)]
    heading_deg: f32,
    time: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceText {
    who: String,
    seen_from: String,
    #[serde(default)]
    ahead: f32,
    #[serde(default)]
    left: f32,
    #[serde(default = "face_to_face")]
    turn_deg: f32,
}

fn face_to_face() -> f32 {
    180.0
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TouchText {
    a: String,
    b: String,
    from: String,
    to: String,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RowText {
    roles: Vec<String>,
    count: usize,
    spacing: f32,
    #[serde(default)]
    delay: f32,
}

impl Composition {
    /// Reads and checks the text of a compose file.
    ///
    /// # Errors
    /// The first problem, with its line.
    pub fn parse(text: &str) -> Result<Self> {
        let raw: Text = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |s| line_of(text, s.start));
            bad(line, e.message().to_owned())
        })?;
        Reader { text }.read(raw)
    }
}

struct Reader<'a> {
    text: &'a str,
}

impl Reader<'_> {
    fn read(&self, raw: Text) -> Result<Composition> {
        if raw.name.get_ref().is_empty() {
            return Err(bad(self.line(raw.name.span()), "expected a name, found none".into()));
        }
        let limits = self.limits(raw.limits)?;
        let clips = raw.clips.into_iter().map(|(name, clip)| self.clip(name, clip)).collect::<Result<Vec<_>>>()?;
        let mut roles: Vec<Role> = Vec::new();
        for role in raw.roles {
            let role = self.role(role, &clips)?;
            if roles.iter().any(|r| r.name == role.name) {
                return Err(bad(role.line, format!("expected another name, found a second role '{}'", role.name)));
            }
            roles.push(role);
        }
        if roles.is_empty() {
            return Err(bad(1, "expected at least one role, found none".into()));
        }
        let names = Names { roles: &roles, clips: &clips };
        let places = raw.places.into_iter().map(|p| self.place(p, &names)).collect::<Result<Vec<_>>>()?;
        let touches = raw.touches.into_iter().map(|t| self.touch(t, &names)).collect::<Result<Vec<_>>>()?;
        let props = raw.props.into_iter().map(|p| {
            let line = self.line(p.span());
            p.into_inner().read(line, &names)
        });
        let props = props.collect::<Result<Vec<_>>>()?;
        let row = raw.row.map(|row| self.row(row, &names)).transpose()?;
        let (name, labels) = (raw.name.into_inner(), raw.labels);
        let story = Composition { name, labels, limits, clips, roles, places, touches, props };
        Ok(row.map_or_else(|| story.clone(), |row| row::lay_out(&story, &row)))
    }

    fn line(&self, span: Range<usize>) -> usize {
        line_of(self.text, span.start)
    }

    fn limits(&self, limits: Option<Spanned<String>>) -> Result<Limits> {
        match limits.as_ref().map(|l| l.get_ref().as_str()) {
            None | Some("tight") => Ok(Limits::TIGHT),
            Some("published") => Ok(Limits::PUBLISHED),
            Some(other) => {
                let line = limits.as_ref().map_or(1, |l| self.line(l.span()));
                Err(bad(line, format!("expected limits \"tight\" or \"published\", found {other:?}")))
            }
        }
    }

    fn clip(&self, name: String, clip: Spanned<ClipText>) -> Result<Clip> {
        let line = self.line(clip.span());
        let text = clip.into_inner();
        let times = [text.from, text.to].into_iter().flatten();
        if let Some(time) = times.into_iter().find(|t| !(0.0..=LARGEST).contains(t)) {
            return Err(bad(line, format!("clip {name}: expected times from 0 to {LARGEST} s, found {time}")));
        }
        let end = match text.end {
            None => None,
            Some(EndText { ahead, left, turn_deg }) => {
                self.finite(line, &[ahead, left, turn_deg])?;
                Some(Ground::new(Vec2::new(left, ahead), turn_deg.to_radians()))
            }
        };
        let (arms, mirror, looped) = (text.arms, text.mirror, text.looped);
        let piece = match text {
            ClipText { take: Some(take), patch: None, role: None, person, from, to, .. } => {
                Piece::Take { name: take, person: person.unwrap_or(0), from, to }
            }
            ClipText { patch: Some(patch), role, take: None, person: None, from: None, to: None, .. } => {
                Piece::Patch { name: patch, role: role.unwrap_or(0) }
            }
            _ => {
                let expected = "expected either take (with person, from, to) or patch (with role)";
                return Err(bad(line, format!("clip {name}: {expected}, found another mixture")));
            }
        };
        Ok(Clip { name, piece, arms, mirror, looped, end, line })
    }

    fn role(&self, role: Spanned<RoleText>, clips: &[Clip]) -> Result<Role> {
        let line = self.line(role.span());
        let RoleText { name, plays, start } = role.into_inner();
        if name.is_empty() || name.contains(['.', '@']) {
            return Err(bad(line, format!("expected a role's name without '.' and '@', found '{name}'")));
        }
        if !(1..=MOST_CLIPS).contains(&plays.len()) {
            return Err(bad(line, format!("role {name}: expected 1 to {MOST_CLIPS} clips, found {}", plays.len())));
        }
        let find = |clip: &String| {
            let found = clips.iter().position(|c| &c.name == clip);
            found.ok_or_else(|| bad(line, format!("role {name}: expected one of the clips, found '{clip}'")))
        };
        let plays = plays.iter().map(find).collect::<Result<Vec<_>>>()?;
        let start = match start {
            None => None,
            Some(s) => {
                self.finite(line, &[s.x, s.z, s.heading_deg, s.time.unwrap_or(0.0)])?;
                Some((Ground::new(Vec2::new(s.x, s.z), s.heading_deg.to_radians()), s.time))
            }
        };
        Ok(Role { name, plays, start, line })
    }

    fn finite(&self, line: usize, values: &[f32]) -> Result<()> {
        match values.iter().find(|v| v.is_nan() || v.abs() > LARGEST) {
            Some(value) => Err(bad(line, format!("expected numbers within {LARGEST}, found {value}"))),
            None => Ok(()),
        }
    }

    fn place(&self, place: Spanned<PlaceText>, names: &Names) -> Result<Place> {
        let line = self.line(place.span());
        let text = place.into_inner();
        self.finite(line, &[text.ahead, text.left, text.turn_deg])?;
        let (who, seen_from) = (names.moment(&text.who, line)?, names.moment(&text.seen_from, line)?);
        if who.role == seen_from.role {
            return Err(bad(line, format!("expected two roles, found '{}' seen from itself", text.who)));
        }
        if who.seconds.is_some() != seen_from.seconds.is_some() {
            let found = format!("found '{}' and '{}'", text.who, text.seen_from);
            return Err(bad(line, format!("expected two moments (with @) or two clips, {found}")));
        }
        let at = Ground::new(Vec2::new(text.left, text.ahead), text.turn_deg.to_radians());
        Ok(Place { who, seen_from, at, delay: 0.0, line })
    }

    fn touch(&self, touch: Spanned<TouchText>, names: &Names) -> Result<Touches> {
        let line = self.line(touch.span());
        let text = touch.into_inner();
        let sides = [names.body_part(&text.a, line)?, names.body_part(&text.b, line)?];
        let is_hand = |part: BodyPart| matches!(part, BodyPart::LeftHand | BodyPart::RightHand);
        if sides[0].0 == sides[1].0 || !sides.iter().any(|s| is_hand(s.1)) {
            let found = format!("found '{}' and '{}'", text.a, text.b);
            return Err(bad(line, format!("expected two roles, one or both with a hand, {found}")));
        }
        let moment = |text: &str| match names.moment(text, line)? {
            moment if moment.seconds.is_some() => Ok(moment),
            _ => Err(bad(line, format!("expected a moment (with @), found '{text}'"))),
        };
        Ok(Touches { sides, from: moment(&text.from)?, to: moment(&text.to)?, line })
    }

    fn row(&self, row: Spanned<RowText>, names: &Names) -> Result<Row> {
        let line = self.line(row.span());
        let RowText { roles, count, spacing, delay } = row.into_inner();
        self.finite(line, &[spacing, delay])?;
        if roles.is_empty() || !(2..=MOST_PEOPLE).contains(&count) || delay < 0.0 {
            let expected = format!("expected roles, a count from 2 to {MOST_PEOPLE} and a delay of 0 or more");
            return Err(bad(line, format!("{expected}, found {} roles, {count} and {delay}", roles.len())));
        }
        let people = names.roles.len() + roles.len() * (count - 1);
        if people > MOST_PEOPLE {
            return Err(bad(line, format!("expected at most {MOST_PEOPLE} people, found {people}")));
        }
        let roles = roles.iter().map(|name| names.role(name, line)).collect::<Result<Vec<_>>>()?;
        Ok(Row { roles, count, spacing, delay, line })
    }
}

fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|&&b| b == b'\n').count() + 1
}
