//! Keys of an animation, and what they say between them (glTF 2.0, appendix C).

use std::collections::BTreeMap;
use std::rc::Rc;

use glam::{DQuat, DVec3, DVec4};
use gltf_json::Animation;
use gltf_json::accessor::Type;
use gltf_json::animation::{Interpolation, Property};
use gltf_json::validation::Checked;

use crate::Result;
use crate::gltf::{Data, Numbers, bad, find};
use crate::motion::nodes::Local;

/// The keys of one property of one node.
pub(super) struct Keys {
    pub times: Rc<[f32]>,
    values: Rc<[f32]>,
    pub interpolation: Interpolation,
    width: usize,
}

/// What an animation does to one node.
#[derive(Default)]
pub(super) struct Tracks {
    pub translation: Option<Keys>,
    pub rotation: Option<Keys>,
    pub scale: Option<Keys>,
}

/// The tracks of the nodes in `wanted`.
pub(super) fn tracks(
    data: &mut Data,
    animation: &Animation,
    wanted: impl Fn(usize) -> bool,
) -> Result<BTreeMap<usize, Tracks>> {
    let mut tracks: BTreeMap<usize, Tracks> = BTreeMap::new();
    for (i, channel) in animation.channels.iter().enumerate() {
        let node = channel.target.node.value();
        let Checked::Valid(path) = channel.target.path else { continue };
        if path == Property::MorphTargetWeights || !wanted(node) {
            continue;
        }
        let place = format!("animation '{}' channel {i}", animation.name.as_deref().unwrap_or_default());
        // Samplers are numbered within their animation.
        let sampler = find(&animation.samplers, channel.sampler, "samplers", &place)?;
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(bad(place, "expected LINEAR, STEP or CUBICSPLINE, found another interpolation"));
        };
        let (kind, width) = if path == Property::Rotation { (Type::Vec4, 4) } else { (Type::Vec3, 3) };
        let times = data.floats(sampler.input, &[Type::Scalar], Numbers::Any, &place)?.values;
        let values = data.floats(sampler.output, &[kind], Numbers::Any, &place)?.values;
        let keys = Keys { times, values, interpolation, width };
        keys.check().map_err(|problem| bad(place, problem))?;
        let node = tracks.entry(node).or_default();
        match path {
            Property::Translation => node.translation = Some(keys),
            Property::Rotation => node.rotation = Some(keys),
            _ => node.scale = Some(keys),
        }
    }
    Ok(tracks)
}

impl Keys {
    fn check(&self) -> std::result::Result<(), String> {
        let per_key = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let (found, needed) = (self.values.len() / self.width, self.times.len() * per_key);
        if self.times.is_empty() || found != needed {
            return Err(format!(
                "expected a value for each of {} keys, found {found} values for {needed}",
                self.times.len()
            ));
        }
        let rising = self.times.windows(2).all(|pair| pair[0] < pair[1]);
        if !rising || !self.times.iter().all(|t| t.is_finite()) {
            return Err("expected finite times in rising order, found others".into());
        }
        match self.values.iter().find(|v| !v.is_finite()) {
            Some(value) => Err(format!("expected finite values, found {value}")),
            None => Ok(()),
        }
    }

    fn value(&self, index: usize) -> DVec4 {
        let v = &self.values[index * self.width..(index + 1) * self.width];
        DVec4::new(v[0].into(), v[1].into(), v[2].into(), if self.width > 3 { v[3].into() } else { 0.0 })
    }

    /// The value at a time. `mix` interpolates linearly. A time less than `slack` from a key is at the key.
    fn at(&self, time: f64, slack: f64, mix: impl Fn(DVec4, DVec4, f64) -> DVec4) -> DVec4 {
        let after = self.times.partition_point(|&t| f64::from(t) <= time + slack);
        let cubic = self.interpolation == Interpolation::CubicSpline;
        let plain = |key: usize| self.value(if cubic { 3 * key + 1 } else { key });
        if after == 0 || after == self.times.len() {
            return plain(after.saturating_sub(1));
        }
        let (begin, end) = (f64::from(self.times[after - 1]), f64::from(self.times[after]));
        if time - begin < slack {
            return plain(after - 1);
        }
        let s = ((time - begin) / (end - begin)).clamp(0.0, 1.0);
        match self.interpolation {
            Interpolation::Step => plain(after - 1),
            Interpolation::Linear => mix(plain(after - 1), plain(after), s),
            Interpolation::CubicSpline => {
                let leaving = self.value(3 * (after - 1) + 2) * (end - begin);
                let arriving = self.value(3 * after) * (end - begin);
                let (s2, s3) = (s * s, s * s * s);
                let ends = plain(after - 1) * (2.0 * s3 - 3.0 * s2 + 1.0) + plain(after) * (3.0 * s2 - 2.0 * s3);
                ends + leaving * (s3 - 2.0 * s2 + s) + arriving * (s3 - s2)
            }
        }
    }
}

impl Tracks {
    /// Where the node is at a time; what has no keys is as at rest.
    pub fn local(&self, rest: &Local, time: f64, slack: f64) -> Local {
        let lerp = |a: DVec4, b: DVec4, s: f64| a.lerp(b, s);
        let vector = |keys: &Option<Keys>, rest: DVec3| -> DVec3 {
            keys.as_ref().map_or(rest, |keys| keys.at(time, slack, lerp).truncate())
        };
        let slerp = |a: DVec4, b: DVec4, s: f64| DVec4::from(turn(a).slerp(turn(b), s));
        Local {
            translation: vector(&self.translation, rest.translation),
            rotation: self.rotation.as_ref().map_or(rest.rotation, |keys| turn(keys.at(time, slack, slerp))),
            scale: vector(&self.scale, rest.scale),
        }
    }
}

/// Numbers as a rotation; those of no length are none.
pub(super) fn turn(v: DVec4) -> DQuat {
    let v = v.normalize_or_zero();
    if v == DVec4::ZERO { DQuat::IDENTITY } else { DQuat::from_vec4(v) }
}
