//! Fits the LTC tables and writes them to the file named, `bake/src/area_light/ltc_tables.bin` in the repository.

use glint_bake_core::area_light::fit::fit_tables;
use glint_bake_core::area_light::quality::table_error;
use std::time::Instant;

fn main() {
    let Some(file) = std::env::args().nth(1) else {
        eprintln!("usage: fit_ltc_tables FILE");
        std::process::exit(2);
    };
    let start = Instant::now();
    let tables = fit_tables();
    let seconds = start.elapsed().as_secs_f64();
    std::fs::write(&file, tables.to_bytes()).expect("writing the tables");
    let error = table_error(&tables);
    println!("{file}: fitted in {seconds:.2} s, mean relative error {:.4}, worst {:.4}", error.mean, error.worst);
}
