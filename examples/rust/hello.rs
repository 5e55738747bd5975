//! The program of examples/c in Rust. Crate redman_sys is what bindgen makes of redman.h.
//!
//!     hello POLICY [bench]
use redman_sys::*;
use std::ffi::{CStr, CString};
use std::os::raw::{c_long, c_void};
use std::{mem, ptr};

extern "C" {
    fn clock() -> c_long; // CPU time of the process, us
}

type Result<T> = std::result::Result<T, String>;

fn check(result: rdm_result) -> Result<()> {
    if result == RDM_OK {
        return Ok(());
    }
    Err(unsafe { CStr::from_ptr(rdm_last_error()) }.to_string_lossy().into_owned())
}

/// A struct of redman's with struct_size set, filled by `fill`.
fn filled<T>(fill: impl FnOnce(*mut T) -> rdm_result) -> Result<T> {
    let mut value = mem::MaybeUninit::<T>::zeroed();
    unsafe { *value.as_mut_ptr().cast::<u32>() = mem::size_of::<T>() as u32 };
    check(fill(value.as_mut_ptr()))?;
    Ok(unsafe { value.assume_init() })
}

struct Pool {
    handle: *mut rdm_pool,
}

// A pool is used by one thread at a time, and is not bound to a thread.
unsafe impl Send for Pool {}

impl Pool {
    /// Worlds at the start of their first episode, with actions that hold the start pose.
    fn new(task: &str, num_envs: i32, seed: u64) -> Result<Pool> {
        let task = CString::new(task).unwrap();
        let mut pool = Pool { handle: ptr::null_mut() };
        unsafe {
            let mut config = filled(|c: *mut rdm_pool_config| rdm_pool_config_init(c, mem::size_of_val(&*c)))?;
            config.task = task.as_ptr();
            config.num_envs = num_envs;
            config.seed = seed;
            config.autoreset = RDM_AUTORESET_NEXT_STEP as i32; // ended worlds rest until the next step
            check(rdm_pool_create(&mut pool.handle, &config))?;
            check(rdm_pool_reset(pool.handle, ptr::null(), ptr::null()))?;
            check(rdm_pool_baseline(pool.handle, RDM_BASELINE_HOLD as i32))?;
        }
        Ok(pool)
    }
    fn step(&mut self) -> Result<()> {
        check(unsafe { rdm_pool_step(self.handle) })
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        unsafe { rdm_pool_destroy(self.handle) }
    }
}

/// 75 steps, without a policy the start pose is held: return and cost of world 0, hash of all states.
fn play(policy: Option<*const rdm_policy>) -> Result<(f64, f64, u64)> {
    let mut pool = Pool::new("hand_over_safe_finger", 4, 7)?;
    let spec: rdm_spec = filled(|s| unsafe { rdm_pool_get_spec(pool.handle, s) })?;
    let rows: rdm_buffers = filled(|b| unsafe { rdm_pool_get_buffers(pool.handle, b) })?;
    let (mut scratch, mut repeat) = (vec![], 1);
    if let Some(policy) = policy {
        check(unsafe { rdm_policy_check(policy, &spec) })?;
        scratch.resize(unsafe { rdm_policy_scratch(policy, 4) }, 0u8);
        repeat = filled(|i: *mut rdm_policy_info| unsafe { rdm_policy_get_info(policy, i) })?.action_repeat;
    }
    let (mut sum, mut cost, mut hash) = (0.0, 0.0, 0);
    for t in 0..75 {
        if let (Some(policy), 0) = (policy, t % repeat) {
            let (bytes, size) = (scratch.as_mut_ptr().cast::<c_void>(), scratch.len());
            check(unsafe { rdm_policy_act(policy, rows.obs, 4, ptr::null(), rows.action, bytes, size) })?;
        }
        pool.step()?;
        sum += f64::from(unsafe { *rows.reward });
        cost += f64::from(unsafe { *rows.cost });
    }
    check(unsafe { rdm_pool_get_hash(pool.handle, -1, &mut hash) })?;
    Ok((sum, cost, hash))
}

/// CPU seconds of one step of the pool.
fn measure(task: &str, num_envs: i32, calls: u32) -> Result<f64> {
    let mut pool = Pool::new(task, num_envs, 0)?;
    (0..calls).try_for_each(|_| pool.step())?; // warms up
    let start = unsafe { clock() };
    (0..calls).try_for_each(|_| pool.step())?;
    Ok((unsafe { clock() } - start) as f64 * 1e-6 / calls as f64)
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let path = CString::new(arguments.next().ok_or("usage: hello POLICY [bench]")?).unwrap();
    let (_, cost, hash) = play(None)?;
    println!("hold cost {cost:.0} hash {hash:016x}");
    let mut policy = ptr::null_mut();
    check(unsafe { rdm_policy_read_file(&mut policy, path.as_ptr()) })?;
    let (sum, cost, hash) = play(Some(policy))?;
    println!("policy return {sum:.4} cost {cost:.0} hash {hash:016x}");
    unsafe { rdm_policy_destroy(policy) };
    if arguments.next().is_some() {
        println!("bandit {:.0} ns a step", 1e9 * measure("bandit", 1, 1_000_000)?);
        println!("hand_over {:.0} steps/s of 1 world", 1.0 / measure("hand_over_safe_finger", 1, 40_000)?);
        println!("hand_over {:.0} steps/s of 64 worlds", 64.0 / measure("hand_over_safe_finger", 64, 1_000)?);
    }
    Ok(())
}
