use iibt_core::inference::Policy;

static POLICY: Policy = Policy::of(&[1, 16]);

fn main() {
    let _ = &POLICY;
}
