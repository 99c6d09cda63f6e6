//! Acting: what an actor does besides going places. All times are seconds from the actor's cursor on.

use glam::Vec3;

use super::actor::Actor;
use super::gesture::{ELBOW, Grip, Reach};
use super::posture::Channel;
use super::timeline::Span;
use crate::motion::Foot;

/// A channel moved by some amount over a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    pub channel: Channel,
    pub span: Span,
    pub amount: f32,
}

/// What the eyes are on.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sight {
    /// Another person of the take.
    Person(usize),
    /// A place relative to the path's frame.
    Beside(Vec3),
}

impl Actor {
    fn span(&self, times: [f32; 4]) -> Span {
        Span(times.map(|t| t + self.t()))
    }

    /// Moves a channel by `amount`, over the span of times.
    pub fn pulse(&mut self, channel: Channel, times: [f32; 4], amount: f32) {
        let span = self.span(times);
        self.pulses.push(Pulse { channel, span, amount });
    }

    /// Several channels over one span.
    pub fn pose(&mut self, times: [f32; 4], amounts: &[(Channel, f32)]) {
        for &(channel, amount) in amounts {
            self.pulse(channel, times, amount);
        }
    }

    /// Looks at something.
    pub fn look(&mut self, times: [f32; 4], sight: Sight) {
        let span = self.span(times);
        self.gazes.push((span, sight));
    }

    /// Leads a hand along grips.
    pub fn reach(&mut self, side: Foot, times: [f32; 4], grips: Vec<(f32, Grip)>) {
        self.reach_with(side, times, grips, ELBOW);
    }

    /// Leads a hand along grips with the elbow towards a direction of the chest's frame (given for the left arm).
    pub fn reach_with(&mut self, side: Foot, times: [f32; 4], grips: Vec<(f32, Grip)>, elbow: Vec3) {
        let t = self.t();
        let grips = grips.into_iter().map(|(at, g)| (at + t, g)).collect();
        self.reaches.push(Reach { side, span: self.span(times), grips, elbow });
    }
}
