//! `canonform serve`.

use std::process::ExitCode;

use anyhow::Result;
use server::Server;

use crate::args::ServeArgs;
use crate::output::count;

/// Serves an index until it is interrupted.
pub(crate) fn serve(args: &ServeArgs) -> Result<ExitCode> {
    let server = Server::bind(&args.index, args.options())?;
    let stop = server.stop_handle();
    base::terminal::on_interruption(move || {
        base::terminal::note("finishing the requests in progress; interrupt again to stop at once");
        stop.stop();
    });
    let address = server.address();
    if !address.ip().is_loopback() {
        base::terminal::note(&format!(
            "warning: {address} is open to other machines: they can search, and see the index and its meshes"
        ));
    }
    let (shapes, index) = (count(server.n_shapes(), "shape"), args.index.display());
    base::terminal::note(&format!("listening on http://{address} ({shapes} in {index})"));
    server.run()?;
    Ok(ExitCode::SUCCESS)
}
