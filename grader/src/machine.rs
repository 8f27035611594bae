//! Runs a module that nobody trusts: it imports nothing, and its steps, memory and stack are
//! counted.
//!
//! The engine is wasmtime. It compiles a module before it runs it, which takes 0.3 s for ten
//! reference answers, and then all of their checks take 0.5 s on one core; in wasmi, which
//! interprets, they begin at once and take 3.1 s.

use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use exercise_spec::answer::{Fault, Transport};
use wasmtime::{
    Config, Engine, Instance, Memory, Module, ResourceLimiter, Store, Trap, TypedFunc,
    UpdateDeadline,
};

use crate::budget::{Purse, processor_time};
use crate::text::harmless;

/// Steps that an answer may take in one check. The reference answers take a thirtieth of it at
/// most.
pub const STEPS: u64 = 4_000_000_000;
/// Steps that it may take in each check after one in which it took too many, so that nobody waits
/// for a loop that does not end as often as there are checks. The reference answers take a quarter
/// of it at most.
pub const FEWER_STEPS: u64 = 500_000_000;
/// Memory that an answer may have, in bytes.
const MEMORY: usize = 256 << 20;
/// Megabytes that a check takes, with the numbers that come back.
pub const INSTANCE: u64 = 300;
/// Megabytes that it takes to make a module ready.
pub const LOADING: u64 = 300;
/// Stack that an answer may use, in bytes.
const STACK: usize = 1 << 20;
/// The longest output, in bytes.
const LONGEST: usize = 16 << 20;
/// How often an answer is asked to pay for the processor's time that it took.
const TICK: Duration = Duration::from_millis(50);
/// Time that a check may take by the clock. The processor's time is paid for, so this says that the
/// machine is too busy, and not that the answer is wrong.
const PATIENCE: Duration = Duration::from_secs(600);
/// The most functions that may be called by their numbers.
const TABLE: usize = 100_000;

/// A machine for modules.
pub struct Machine {
    engine: Engine,
    /// Whether the clock goes on.
    running: Arc<AtomicBool>,
}

impl Machine {
    /// A machine whose clock runs.
    ///
    /// # Errors
    ///
    /// When this computer has no such machine.
    pub fn new() -> Result<Self, String> {
        let mut config = Config::new();
        config.consume_fuel(true).epoch_interruption(true).max_wasm_stack(STACK);
        config.cranelift_opt_level(wasmtime::OptLevel::None).cranelift_nan_canonicalization(true);
        config.wasm_memory64(false).memory_reservation(MEMORY as u64);
        let engine = Engine::new(&config)
            .map_err(|error| format!("WebAssembly cannot be run here: {error}"))?;
        let running = Arc::new(AtomicBool::new(true));
        let (clock, goes_on) = (engine.clone(), Arc::clone(&running));
        thread::spawn(move || {
            while goes_on.load(Ordering::Relaxed) {
                thread::sleep(TICK);
                clock.increment_epoch();
            }
        });
        Ok(Self { engine, running })
    }

    /// Takes a module in.
    ///
    /// # Errors
    ///
    /// When it is none, or imports something.
    pub fn load(&self, module: &[u8]) -> Result<Program, String> {
        let module = Module::new(&self.engine, module).map_err(|error| {
            format!("The module cannot be loaded: {}", harmless(&error.to_string(), 300))
        })?;
        if let Some(import) = module.imports().next() {
            return Err(format!(
                "The compiled answer wants {} from outside. It gets nothing from there: leave out what calls the \
                 system or foreign code.",
                harmless(import.name(), 80)
            ));
        }
        Ok(Program { module })
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        self.running.store(false, Ordering::Relaxed);
    }
}

/// A module that can be run.
pub struct Program {
    module: Module,
}

impl Program {
    /// A fresh instance, for one check: what an answer keeps does not reach the next one.
    /// `exercise` is the number of the exercise in the module, `steps` is how many it may take, and
    /// `purse` pays for the processor's time.
    pub fn answer(&self, exercise: usize, steps: u64, purse: &Purse) -> Answer {
        let (state, end) = match Running::start(&self.module, steps, purse.clone()) {
            Ok(running) => (Ok(running), None),
            Err(stop) => (Err(stop.clone().fault()), Some(stop)),
        };
        Answer { exercise, state: Mutex::new(state), end: Mutex::new(end) }
    }
}

/// One instance, which checks can call.
pub struct Answer {
    exercise: usize,
    state: Mutex<Result<Running, Fault>>,
    end: Mutex<Option<Stop>>,
}

impl Answer {
    /// Why what was observed says nothing about the answer, if it does not.
    pub fn unjust(&self) -> Option<String> {
        match self.end() {
            Some(Stop::Unjust(why)) => Some(why),
            _ => None,
        }
    }

    /// Whether it took more steps than it may.
    pub fn took_too_long(&self) -> bool {
        matches!(self.end(), Some(Stop::Steps(_)))
    }

    fn end(&self) -> Option<Stop> {
        self.end.lock().map_or(None, |end| end.clone())
    }
}

impl Transport for Answer {
    fn call(&self, function: usize, input: &[u8]) -> Result<Vec<u8>, Fault> {
        let Ok(mut state) = self.state.lock() else { return Err(stopped("the instance is gone")) };
        let running = state.as_mut().map_err(|fault| fault.clone())?;
        running.call(self.exercise, function, input).map_err(|stop| {
            if let Ok(mut end) = self.end.lock() {
                *end = Some(stop.clone());
            }
            let fault = stop.fault();
            // Whatever stopped it, its memory may be in disorder.
            *state = Err(fault.clone());
            fault
        })
    }
}

/// Why a call has no output.
#[derive(Clone)]
enum Stop {
    /// The answer is to blame.
    Fault(Fault),
    /// It is, because it took more steps than these.
    Steps(u64),
    /// It is, because it took all the time that there was.
    Spent,
    /// The answer is not to blame.
    Unjust(String),
}

impl Stop {
    fn fault(self) -> Fault {
        match self {
            Self::Fault(fault) => fault,
            Self::Steps(steps) => stopped(format!(
                "it took more than {} million steps. Is there a loop that does not end?",
                steps / 1_000_000
            )),
            Self::Spent => no_time(),
            Self::Unjust(why) => Fault::Stopped(why),
        }
    }
}

fn stopped(sentence: impl Into<String>) -> Fault {
    Fault::Stopped(sentence.into())
}

/// What is said of an answer that has no time left.
pub fn no_time() -> Fault {
    stopped(
        "it took more time, in all its checks, than an answer may. Is there a loop that does not end, that asks for \
         memory again and again, or that reads a large table in leaps?",
    )
}

fn too_much_memory() -> Fault {
    stopped(format!("it needs more memory than the {} MB it may have", MEMORY >> 20))
}

/// What an instance may have, and whether it wanted more.
struct Limits {
    exceeded: bool,
    purse: Purse,
    /// Processor time of the thread up to which it is paid.
    paid: Duration,
    begun: Instant,
}

impl Limits {
    fn new(purse: Purse) -> Self {
        Self { exceeded: false, purse, paid: processor_time(), begun: Instant::now() }
    }

    /// Pays for the time since the last payment, and lets the answer go on if there was as much.
    fn pay(&mut self) -> wasmtime::Result<UpdateDeadline> {
        let now = processor_time();
        let enough = self.purse.pay(now.saturating_sub(self.paid));
        self.paid = now;
        if enough && self.begun.elapsed() < PATIENCE {
            return Ok(UpdateDeadline::Continue(1));
        }
        Err(Trap::Interrupt.into())
    }
}

impl Drop for Limits {
    fn drop(&mut self) {
        let _ = self.pay();
    }
}

impl Limits {
    fn allow(&mut self, wanted: usize, most: usize) -> wasmtime::Result<bool> {
        self.exceeded |= wanted > most;
        Ok(wanted <= most)
    }
}

impl ResourceLimiter for Limits {
    fn memory_growing(
        &mut self,
        _: usize,
        wanted: usize,
        _: Option<usize>,
    ) -> wasmtime::Result<bool> {
        self.allow(wanted, MEMORY)
    }

    fn table_growing(
        &mut self,
        _: usize,
        wanted: usize,
        _: Option<usize>,
    ) -> wasmtime::Result<bool> {
        self.allow(wanted, TABLE)
    }
}

/// An instance and what of it is called.
struct Running {
    store: Store<Limits>,
    steps: u64,
    memory: Memory,
    /// Where in memory the words of the latest panic are.
    said: usize,
    allocate: TypedFunc<u32, u32>,
    call: TypedFunc<(u32, u32, u32, u32), u64>,
}

impl Running {
    fn start(module: &Module, steps: u64, purse: Purse) -> Result<Self, Stop> {
        let mut store = Store::new(module.engine(), Limits::new(purse));
        store.limiter(|limits| limits);
        store.set_epoch_deadline(1);
        store.epoch_deadline_callback(|mut store| store.data_mut().pay());
        let unjust = |error: wasmtime::Error| Stop::Unjust(harmless(&error.to_string(), 300));
        store.set_fuel(steps).map_err(unjust)?;
        let instance = match Instance::new(&mut store, module, &[]) {
            Ok(instance) => instance,
            Err(_) if store.data().exceeded => return Err(Stop::Fault(too_much_memory())),
            Err(error) => return Err(unjust(error)),
        };
        let lacks = |what: &str| Stop::Unjust(format!("the module has no {what}"));
        let memory = instance.get_memory(&mut store, "memory").ok_or_else(|| lacks("memory"))?;
        let said = instance
            .get_global(&mut store, "SAID")
            .and_then(|at| at.get(&mut store).i32())
            .ok_or_else(|| lacks("place for words"))?;
        let allocate = instance.get_typed_func(&mut store, "allocate").map_err(unjust)?;
        let call = instance.get_typed_func(&mut store, "call").map_err(unjust)?;
        Ok(Self { store, steps, memory, said: said as u32 as usize, allocate, call })
    }

    fn call(&mut self, exercise: usize, function: usize, input: &[u8]) -> Result<Vec<u8>, Stop> {
        let length = input.len() as u32;
        let at = match self.allocate.call(&mut self.store, length) {
            Ok(at) => at,
            Err(error) => return Err(self.stop(&error)),
        };
        let no_room = |_| Stop::Fault(stopped("there was no room for the input"));
        self.memory.write(&mut self.store, at as usize, input).map_err(no_room)?;
        let arguments = (exercise as u32, function as u32, at, length);
        let output = match self.call.call(&mut self.store, arguments) {
            Ok(output) => output,
            Err(error) => return Err(self.stop(&error)),
        };
        let (at, length) = ((output >> 32) as usize, (output & 0xffff_ffff) as usize);
        if length > LONGEST {
            let sentence =
                format!("the output is too long: {LONGEST} bytes are the most that is read");
            return Err(Stop::Fault(stopped(sentence)));
        }
        let output = self.memory.data(&self.store).get(at..at + length);
        output
            .map(<[u8]>::to_vec)
            .ok_or_else(|| Stop::Fault(stopped("the output is not in the answer's memory")))
    }

    /// What a trap means.
    fn stop(&self, error: &wasmtime::Error) -> Stop {
        let fault = match error.downcast_ref::<Trap>() {
            Some(Trap::OutOfFuel) => return Stop::Steps(self.steps),
            Some(Trap::Interrupt) if self.store.data().purse.is_empty() => return Stop::Spent,
            Some(Trap::Interrupt) => {
                return Stop::Unjust(format!(
                    "the check took longer than {} s; this machine is too busy",
                    PATIENCE.as_secs()
                ));
            }
            // The stack ends where the memory begins, and safe code leaves the memory nowhere else.
            Some(Trap::StackOverflow | Trap::MemoryOutOfBounds) => stopped(
                "the stack is full. Is there a recursion that does not end, or a large array that \
                 should be a `Vec`?",
            ),
            Some(Trap::UnreachableCodeReached) => self.panicked(),
            Some(trap) => stopped(trap.to_string()),
            None => return Stop::Unjust(harmless(&error.to_string(), 300)),
        };
        Stop::Fault(fault)
    }

    /// The panic that the answer has put into words, or what stands for its silence.
    fn panicked(&self) -> Fault {
        let data = self.memory.data(&self.store);
        let bytes = |from: usize, length: usize| data.get(from..from.checked_add(length)?);
        let length = bytes(self.said, 4)
            .map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        let words = bytes(self.said.saturating_add(4), length.min(4092)).unwrap_or_default();
        let words = harmless(&String::from_utf8_lossy(words), 2_000);
        match words.split_once('\n') {
            // Where in a library it happened tells of this machine and not of the answer.
            Some((place, sentence)) if place.starts_with("answers/") => {
                Fault::of_panic(sentence, format!(" at {place}"))
            }
            Some((_, sentence)) => Fault::of_panic(sentence, String::new()),
            None if self.store.data().exceeded => too_much_memory(),
            None => stopped(
                "it aborted without words. Does it leave the process, or want more memory than \
                 there is?",
            ),
        }
    }
}
