//! Rounds of a team: the rules one by one, their ticks, and all that a hostile radio can do to
//! them.

mod exploration;
mod grid;
mod members;
mod model;
mod moves;
mod patience;
mod scores;
mod stage;
mod task;
mod team;
mod ticks;
