use iibt_core::inference::IdentityNoise;

static A: IdentityNoise<4> = IdentityNoise::new(1.2);

fn main() {
    let _ = &A;
}
