//! Presets of import repairs: what is known to be wrong with well-known files, by name.

use super::take::ImportOptions;
use crate::{Error, Result};

/// A named set of repairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Which files it is for.
    pub about: &'static str,
    /// Metres per unit of the file's lengths.
    pub metres_per_unit: f32,
    /// True frames per second, where the header is wrong.
    pub fps: Option<f32>,
    /// Leading frames to drop.
    pub drop_first_frames: u32,
    /// Whether the thorax bone is lost.
    pub restore_thorax: bool,
}

/// CMU's unit: inches at a scale of 0.45.
const CMU_UNIT: f32 = 0.0254 / 0.45;

/// All presets. What a file's options say themselves overrides them, one by one.
pub const PRESETS: [Preset; 6] = [
    Preset {
        name: "cmu-mb",
        about: "CMU by cgspeed for MotionBuilder: a T-pose in front, the thorax lost",
        metres_per_unit: CMU_UNIT,
        fps: None,
        drop_first_frames: 1,
        restore_thorax: true,
    },
    Preset {
        name: "cmu-max",
        about: "CMU by cgspeed for 3ds Max, as found without its T-pose: the thorax lost",
        metres_per_unit: CMU_UNIT,
        fps: None,
        drop_first_frames: 0,
        restore_thorax: true,
    },
    Preset {
        name: "cmu-daz",
        about: "CMU by cgspeed for Daz, in centimetres: a T-pose blends out over 8 frames",
        metres_per_unit: 0.01,
        fps: None,
        drop_first_frames: 8,
        restore_thorax: false,
    },
    Preset {
        name: "cmu-daz-128",
        about: "the same scaled by 1/128, of subjects captured at 60 frames per second (salsa: 60, 61)",
        metres_per_unit: 1.28,
        fps: Some(60.0),
        drop_first_frames: 8,
        restore_thorax: false,
    },
    Preset {
        name: "cmu-asf",
        about: "CMU's own ASF/AMC, which says no frame rate: 120 per second",
        metres_per_unit: CMU_UNIT,
        fps: Some(120.0),
        drop_first_frames: 0,
        restore_thorax: false,
    },
    Preset {
        name: "centimetres",
        about: "Mixamo, Rokoko, Xsens, Unreal and most others",
        metres_per_unit: 0.01,
        fps: None,
        drop_first_frames: 0,
        restore_thorax: false,
    },
];

impl ImportOptions {
    /// The options with what the preset says where they say nothing themselves, and without the preset.
    ///
    /// # Errors
    /// A preset that does not exist.
    pub fn resolved(&self) -> Result<Self> {
        let Some(name) = &self.preset else { return Ok(self.clone()) };
        let Some(preset) = PRESETS.iter().find(|p| p.name == name) else {
            let known: Vec<&str> = PRESETS.iter().map(|p| p.name).collect();
            let problem = format!("expected one of {}, found '{name}'", known.join(", "));
            return Err(Error::invalid("options", "import.preset", problem));
        };
        Ok(Self {
            preset: None,
            metres_per_unit: self.metres_per_unit.or(Some(preset.metres_per_unit)),
            fps: self.fps.or(preset.fps),
            drop_first_frames: self.drop_first_frames.or(Some(preset.drop_first_frames)),
            restore_thorax: self.restore_thorax.or(Some(preset.restore_thorax)),
            ..self.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_overrides_the_preset() {
        let preset = ImportOptions { preset: Some("cmu-mb".into()), ..Default::default() };
        let plain = preset.resolved().unwrap();
        assert_eq!((plain.drop_first_frames, plain.restore_thorax, plain.fps), (Some(1), Some(true), None));
        let said = ImportOptions { drop_first_frames: Some(0), restore_thorax: Some(false), ..preset };
        let said = said.resolved().unwrap();
        assert_eq!((said.drop_first_frames, said.restore_thorax), (Some(0), Some(false)));
        assert_eq!(said.metres_per_unit, Some(CMU_UNIT));
        let wrong = ImportOptions { preset: Some("cmu".into()), ..Default::default() };
        let told = wrong.resolved().unwrap_err().to_string();
        assert!(told.contains("cmu-daz-128") && told.contains("'cmu'"), "{told}");
    }
}
