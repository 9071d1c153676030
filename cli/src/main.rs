//! The program `sinscal`.

fn main() -> std::process::ExitCode {
    sinscal_cli::Program::standard().run()
}
