//! Rounds of a team: the rules one by one, their ticks, and all that a hostile radio can do to them.

mod exploration;
mod grid;
mod model;
mod rules;
mod task;
mod team;
mod ticks;
