//! What `examples/consistency` says of the policies.

use std::collections::BTreeMap;

use vislam::consistency::Policy;

use crate::data::NotMade;
use crate::release::said;

/// What the example says of one time: numbers by the policy and their name.
#[derive(Default)]
pub struct Time(BTreeMap<(String, String), f64>);

impl Time {
    /// A number of a line.
    pub fn of(&self, line: &str, name: &str) -> Result<f64, NotMade> {
        let value = self.0.get(&(line.to_owned(), name.to_owned())).copied();
        value.ok_or_else(|| NotMade::Failed(format!("the example said nothing of {line}’s {name}")))
    }

    /// A number of a policy by that of the policy that is told the truth.
    pub fn by_ideal(&self, policy: Policy, name: &str) -> Result<f64, NotMade> {
        Ok(self.of(policy.name(), name)? / self.of(Policy::Ideal.name(), name)?)
    }
}

/// What the example says with these arguments, at each of the times.
pub fn told(arguments: &str) -> Result<Vec<Time>, NotMade> {
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    let said = said(&["--package", "vislam", "--example", "consistency"], &arguments)?;
    let mut times = Vec::new();
    for line in said.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["at", ..] => times.push(Time::default()),
            ["policy", policy, ref pairs @ ..] => {
                if times.is_empty() {
                    times.push(Time::default());
                }
                let pairs = pairs.chunks_exact(2);
                let pairs = pairs.filter_map(|pair| {
                    Some(((policy.to_owned(), pair[0].to_owned()), pair[1].parse().ok()?))
                });
                times.iter_mut().last().into_iter().for_each(|time| time.0.extend(pairs.clone()));
            }
            _ => return Err(NotMade::Failed(format!("the example said “{line}”"))),
        }
    }
    Ok(times)
}
