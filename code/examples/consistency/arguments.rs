//! What the example is told.

use vislam::consistency::{NoSuchPolicy, Policy};
use vislam::inertial::ImuNoise;

use crate::flown::{Motion, PERFECT, PICTURE_RATE, Setting};

const USAGE: &str = "usage: consistency [--flights N] [--minutes M] [--seed S] \
                     [--at SECONDS,SECONDS,...] [--policy NAME] [--batch] \
                     [--motion figure-eight|constant-velocity] [--sensor euroc|mems] \
                     [--pixels SIGMA] [--longest-track N] [--clones N] [--kept N] [--perfect-start]";

pub struct Arguments {
    pub flights: u64,
    pub seed: u64,
    /// When the errors are judged, ascending, in seconds.
    pub times: Vec<f64>,
    pub policies: Vec<Policy>,
    /// Whether the minimum over everything is judged as well.
    pub batch: bool,
    pub motion: Motion,
    pub setting: Setting,
}

impl Arguments {
    pub fn read(mut given: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut read = Self {
            flights: 10,
            seed: 0,
            times: vec![60.0],
            policies: Policy::ALL.to_vec(),
            batch: false,
            motion: Motion::FigureEight,
            setting: Setting::default(),
        };
        while let Some(name) = given.next() {
            let mut value = || given.next().ok_or(format!("{name} needs a value; {USAGE}"));
            match name.as_str() {
                "--flights" => read.flights = number(&name, &value()?)?,
                "--minutes" => read.times = vec![60.0 * number::<f64>(&name, &value()?)?],
                "--at" => {
                    let times = value()?;
                    let times = times.split(',').map(|time| number(&name, time));
                    read.times = times.collect::<Result<_, _>>()?;
                }
                "--seed" => read.seed = number(&name, &value()?)?,
                "--batch" => read.batch = true,
                "--pixels" => read.setting.pixel_sigma = number(&name, &value()?)?,
                "--longest-track" => read.setting.longest_track = number(&name, &value()?)?,
                "--clones" => read.setting.clones = number(&name, &value()?)?,
                "--kept" => read.setting.landmarks = number(&name, &value()?)?,
                "--perfect-start" => read.setting.start = PERFECT,
                "--policy" => {
                    let policy = value()?.parse();
                    let told = |error: NoSuchPolicy| format!("{error}; {USAGE}");
                    read.policies = vec![policy.map_err(told)?];
                }
                "--motion" => read.motion = motion(&value()?)?,
                "--sensor" => read.setting.noise = sensor(&value()?)?,
                _ => return Err(format!("unknown argument `{name}`; {USAGE}")),
            }
        }
        read.check()
    }

    fn check(self) -> Result<Self, String> {
        let Setting { clones, longest_track, pixel_sigma, .. } = self.setting;
        let ascending = self.times.windows(2).all(|pair| pair[0] < pair[1]);
        let in_range = self.times.iter().all(|time| (1.0..1e6).contains(time));
        let is_picture = |time: &f64| {
            let pictures = time * PICTURE_RATE;
            (pictures - pictures.round()).abs() < 1e-6
        };
        let wrong = if self.flights == 0 {
            "--flights is 0; give one or more"
        } else if !ascending || !in_range || !self.times.iter().all(is_picture) {
            "times are in seconds, ascending, at least one, and those of pictures, of which there are \
             five a second; --minutes gives the last of them"
        } else if clones < 3 || longest_track < 3 {
            "windows and tracks need three pictures or more"
        } else if !(pixel_sigma > 0.0 && pixel_sigma < 100.0) {
            "--pixels is a standard deviation between 0 and 100"
        } else {
            return Ok(self);
        };
        Err(format!("{wrong}; {USAGE}"))
    }
}

fn motion(name: &str) -> Result<Motion, String> {
    match name {
        "figure-eight" => Ok(Motion::FigureEight),
        "constant-velocity" => Ok(Motion::ConstantVelocity),
        _ => Err(format!("there is no motion `{name}`; {USAGE}")),
    }
}

fn sensor(name: &str) -> Result<ImuNoise, String> {
    match name {
        "euroc" => Ok(ImuNoise::euroc()),
        "mems" => Ok(ImuNoise::mems()),
        _ => Err(format!("there is no sensor `{name}`; {USAGE}")),
    }
}

fn number<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{name} is `{text}`, which is no number that fits; {USAGE}"))
}
