// SPDX-License-Identifier: Apache-2.0
// The C interface from Rust: a closure becomes a sampler.
//   rustc -L FOLDER_OF_THE_LIBRARY sampler.rs
use std::ffi::{c_char, c_int, c_void, CStr};
use std::ptr::{null, null_mut};

type Callback = extern "C" fn(*mut c_void, usize, *const f32, *const f32, *mut f32) -> c_int;
type Release = extern "C" fn(*mut c_void);
type Bits = unsafe extern "C" fn(*mut c_void) -> u32;
#[repr(C)]
struct Pcg32 {
    state: u64,
    increment: u64,
}

#[link(name = "reflectree_c")]
extern "C" {
    fn reflectree_last_error() -> *const c_char;
    fn reflectree_function_callback(
        name: *const c_char, channels: c_int, flags: u32, f: Callback, user: *mut c_void, release: Option<Release>,
        out: *mut *mut c_void,
    ) -> c_int;
    fn reflectree_function_free(f: *mut c_void);
    fn reflectree_build(f: *const c_void, options: *const c_void, out: *mut *mut c_void) -> c_int;
    fn reflectree_sampler_free(s: *mut c_void);
    fn reflectree_pcg32_seed(state: *mut Pcg32, seed: u64, stream: u64);
    fn reflectree_pcg32_next(state: *mut c_void) -> u32;
    fn reflectree_sample_exact(
        s: *const c_void, n: usize, wo: *const f32, bits: Bits, state: *mut c_void, wi: *mut f32, pdf: *mut f32,
        weight: *mut f32,
    ) -> c_int;
}

const CONCURRENT: u32 = 1;
type Function = Box<dyn Fn(&[f32], &[f32]) -> f32 + Send + Sync>;

extern "C" fn evaluate(user: *mut c_void, n: usize, wo: *const f32, wi: *const f32, values: *mut f32) -> c_int {
    // A panic must not leave the callback.
    let all = std::panic::catch_unwind(|| unsafe {
        let f = &*(user as *const Function);
        let (wo, wi) = (std::slice::from_raw_parts(wo, 3 * n), std::slice::from_raw_parts(wi, 3 * n));
        let pairs = wo.chunks(3).zip(wi.chunks(3));
        for (value, (o, i)) in std::slice::from_raw_parts_mut(values, n).iter_mut().zip(pairs) {
            *value = f(o, i);
        }
    });
    all.is_err() as c_int
}
extern "C" fn release(user: *mut c_void) {
    drop(unsafe { Box::from_raw(user as *mut Function) });
    println!("the function is released");
}

fn must(status: c_int) {
    if status != 0 {
        panic!("{}", unsafe { CStr::from_ptr(reflectree_last_error()) }.to_string_lossy());
    }
}

fn main() {
    let amount = 0.3f32;
    // Dust that scatters light once, sr^-1, without cosine.
    let dust: Function = Box::new(move |wo, wi| amount / (wo[2] + wi[2]));
    let (mut f, mut sampler, mut random) = (null_mut(), null_mut(), Pcg32 { state: 0, increment: 0 });
    let n = 100_000;
    let wo: Vec<f32> = (0..n).flat_map(|_| [0.8f32.sin(), 0.0, 0.8f32.cos()]).collect();
    let (mut wi, mut weight) = (vec![0f32; 3 * n], vec![0f32; n]);
    unsafe {
        let user = Box::into_raw(Box::new(dust)) as *mut c_void;
        let name = b"dust\0".as_ptr() as *const c_char;
        must(reflectree_function_callback(name, 1, CONCURRENT, evaluate, user, Some(release), &mut f));
        must(reflectree_build(f, null(), &mut sampler));
        reflectree_function_free(f);
        reflectree_pcg32_seed(&mut random, 1, 0);
        let state = &mut random as *mut Pcg32 as *mut c_void;
        must(reflectree_sample_exact(
            sampler, n, wo.as_ptr(), reflectree_pcg32_next, state, wi.as_mut_ptr(), null_mut(), weight.as_mut_ptr(),
        ));
        reflectree_sampler_free(sampler);
    }
    // Light comes from within 60 degrees of the normal; in closed form the result is 0.484.
    let lit = wi.chunks(3).zip(&weight).filter(|(w, _)| w[2] > 0.5);
    println!("reflected radiance {:.3}", lit.map(|(_, weight)| weight).sum::<f32>() / n as f32);
}
