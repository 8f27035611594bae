//! Flies the same simulated flights with the same filter, linearized in seven ways, and says whether
//! its errors are as large as it believes.
//!
//! ```text
//! cargo run --release -p vislam --example consistency -- \
//!     [--flights N] [--minutes M] [--seed S] [--at SECONDS,SECONDS,...] [--policy NAME] [--batch] \
//!     [--motion figure-eight|constant-velocity] [--sensor euroc|mems] [--pixels SIGMA] \
//!     [--longest-track N] [--clones N] [--kept N] [--perfect-start]
//! ```
//!
//! A flight has 200 readings and five pictures a second. All filters see the same pixels, none of
//! them wrong, and no gate is set. Position and yaw are known exactly at the beginning, as they are
//! what everything else is measured from; tilt, velocity and biases are off by what the filter is told
//! of them, with `--perfect-start` by a thousandth of it.
//!
//! At the end, or at each of the times, a line for each policy has the mean over all flights of the
//! normalized errors squared, each divided by its dimension, the root mean square of the position
//! errors at all pictures until then, in centimetres and without alignment, and the time that a
//! picture took with its readings. Then come the root mean squares of the standard deviation of yaw
//! and of its error, those of the standard deviation of the velocity along itself and of its error,
//! and what the filter has claimed to learn about shifts of everything and about a turn about the
//! vertical, as a part of what its rows would say if nothing cancelled. With `--batch`, the last line
//! of each time is that of the minimum over all readings and pixels until then: there the error is that of
//! the last picture alone, and the time that of the whole batch.

mod arguments;
mod flown;
mod judged;
mod whole;

use std::error::Error;
use std::thread;

use arguments::Arguments;
use judged::Judged;
use vislam::consistency::Policy;

/// For each policy, and for the batch after them, what was judged at each of the times.
type Sums = Vec<Vec<Judged>>;

/// Flies one flight with all policies.
fn fly(arguments: &Arguments, seed: u64) -> Result<Sums, String> {
    let Arguments { setting, motion, times, policies, batch, .. } = arguments;
    let seconds = times.iter().copied().fold(0.0, f64::max);
    let told = |error: &dyn Error| format!("flight {seed}: {error}");
    let recording = flown::flown(*motion, setting, seconds, seed).map_err(|error| told(&error))?;
    let follow = |policy: &Policy| judged::follow(&recording, (setting, *policy), times, seed);
    let mut sums: Sums = policies.iter().map(follow).collect::<Result<_, _>>()?;
    if *batch {
        sums.push(whole::batches(&recording, setting, times, seed)?);
    }
    Ok(sums)
}

/// Flies all flights, on as many threads as there are processors.
fn fly_all(arguments: &Arguments) -> Result<Sums, String> {
    let threads = thread::available_parallelism().map_or(1, usize::from) as u64;
    let fly_share = |share: u64| -> Result<Vec<(u64, Sums)>, String> {
        let seeds = (0..arguments.flights).filter(|flight| flight % threads == share);
        seeds.map(|flight| Ok((flight, fly(arguments, arguments.seed + flight)?))).collect()
    };
    let mut flights = thread::scope(|scope| {
        let run = |share| scope.spawn(move || fly_share(share));
        let running: Vec<_> = (0..threads).map(run).collect();
        let mut flights = Vec::new();
        for share in running {
            flights.extend(share.join().map_err(|_| "a flight was aborted".to_owned())??);
        }
        Ok::<_, String>(flights)
    })?;
    // Added up in the order of the flights, so that the sums do not depend on the threads.
    flights.sort_by_key(|(flight, _)| *flight);
    let mut flights = flights.into_iter().map(|(_, sums)| sums);
    let mut all = flights.next().unwrap_or_default();
    for sums in flights {
        for (all, one) in all.iter_mut().flatten().zip(sums.iter().flatten()) {
            all.add(one);
        }
    }
    Ok(all)
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::read(std::env::args().skip(1))?;
    let sums = fly_all(&arguments)?;
    let names = arguments.policies.iter().map(|policy| policy.name()).chain(["batch"]);
    for (at, seconds) in arguments.times.iter().enumerate() {
        if arguments.times.len() > 1 {
            println!("at {seconds} s");
        }
        for (name, sums) in names.clone().zip(&sums) {
            println!("policy {name}  {}", sums[at]);
        }
    }
    Ok(())
}
