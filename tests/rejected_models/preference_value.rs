use iibt_core::inference::Preference;

static C: Preference<2> = Preference::new([0.0, f32::NAN]);

fn main() {
    let _ = &C;
}
