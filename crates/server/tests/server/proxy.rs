//! Behind the reverse proxy of the guide: nginx with TLS and a password.
//!
//! Skipped without nginx, openssl or curl, unless `CANONFORM_PROXY` is `required`.

use std::fs;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use canonform_server::ServeOptions;
use tempfile::TempDir;

use crate::support::{Served, options};

const NAME: &str = "shapes.example.org";
const USER: &str = "ada:secret";

fn page() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/server.md")).unwrap()
}

/// The configuration in the guide.
fn recipe() -> String {
    page().split("```nginx\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap().to_owned()
}

/// The output of a program that must succeed.
fn run(program: &str, arguments: &[&str]) -> String {
    let done = Command::new(program).args(arguments).output().unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{program} {arguments:?}: {error}");
    String::from_utf8(done.stdout).unwrap().trim().to_owned()
}

/// nginx with the recipe of the guide, in a folder of its own.
struct Proxy {
    process: Child,
    folder: TempDir,
    port: u16,
}

impl Drop for Proxy {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Proxy {
    /// Only ports and files differ from the recipe.
    fn start(server: SocketAddr) -> Option<Self> {
        let is_missing = |program: &&str| Command::new(program).arg("-V").output().is_err();
        if let Some(program) = ["nginx", "openssl", "curl"].into_iter().find(is_missing) {
            let is_required = std::env::var("CANONFORM_PROXY").is_ok_and(|value| value == "required");
            assert!(!is_required, "{program} is missing: apt-get install nginx-light openssl curl");
            println!("skipped: {program} is not installed");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let (key, certificate) = (path("shapes.key"), path("shapes.pem"));
        let making = format!(
            "req -x509 -newkey rsa:2048 -nodes -days 1 -keyout {key} -out {certificate} -subj /CN={NAME} \
             -addext subjectAltName=DNS:{NAME}"
        );
        run("openssl", &making.split(' ').collect::<Vec<_>>());
        let (user, password) = USER.split_once(':').unwrap();
        let hash = run("openssl", &["passwd", "-apr1", password]);
        fs::write(path("shapes.users"), format!("{user}:{hash}\n")).unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let mut recipe = recipe();
        for (given, here) in [
            ("listen 443", format!("listen 127.0.0.1:{port}")),
            ("/etc/nginx", folder.path().display().to_string()),
            ("127.0.0.1:7878", server.to_string()),
        ] {
            assert!(recipe.contains(given), "{given}");
            recipe = recipe.replace(given, &here);
        }
        let temporary: String = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"]
            .map(|kind| format!("{kind}_temp_path {};\n", path(kind)))
            .concat();
        let configuration = format!(
            "daemon off;\nmaster_process off;\npid {};\nevents {{}}\nhttp {{\naccess_log off;\n{temporary}{recipe}}}\n",
            path("pid")
        );
        fs::write(path("nginx.conf"), configuration).unwrap();
        let log = fs::File::create(path("log")).unwrap();
        let mut command = Command::new("nginx");
        command.args(["-p", &path(""), "-c", &path("nginx.conf"), "-e", "stderr"]).stderr(log);
        let process = command.spawn().unwrap();
        let proxy = Self { process, folder, port };
        let start = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            let log = || fs::read_to_string(proxy.folder.path().join("log"));
            assert!(start.elapsed() < Duration::from_secs(20), "nginx does not start: {:?}", log());
            std::thread::sleep(Duration::from_millis(20));
        }
        Some(proxy)
    }

    /// Asks as curl does: the status and the body. The certificate must be that of the host.
    fn curl(&self, host: &str, target: &str, arguments: &[&str]) -> (u16, String) {
        let path = |name: &str| self.folder.path().join(name).display().to_string();
        let address = format!("https://{host}:{}{target}", self.port);
        let resolve = format!("{host}:{}:127.0.0.1", self.port);
        let (certificate, body) = (path("shapes.pem"), path("body"));
        let mut all = vec!["-sS", "--noproxy", "*", "--cacert", &certificate, "--resolve", &resolve];
        all.extend(["-o", &body, "-w", "%{http_code}"]);
        all.extend(arguments);
        all.push(&address);
        let status = run("curl", &all).parse().unwrap();
        (status, fs::read_to_string(body).unwrap())
    }
}

#[test]
fn the_proxy_of_the_guide_passes_requests_on() {
    // As the guide says to start it.
    assert!(page().contains(&format!("--public-host {NAME}\n")));
    let server = Served::start(ServeOptions { public_host: Some(NAME.to_owned()), ..options() });
    let Some(proxy) = Proxy::start(server.address) else { return };
    let ask =
        |target: &str, arguments: &[&str]| proxy.curl(NAME, target, &[&["-u", USER][..], arguments].concat());
    assert_eq!(proxy.curl(NAME, "/", &[]).0, 401, "without the password");
    let (status, page) = ask("/", &[]);
    assert!(status == 200 && page.contains("<title>canonform"), "{page}");

    // An upload beyond the usual limit of nginx.
    let file = proxy.folder.path().join("ring.off");
    let mesh = fs::read_to_string(server.mesh("ring0")).unwrap();
    let comments = format!("# {}\n", "x".repeat(98)).repeat(30_000);
    fs::write(&file, mesh.replacen('\n', &format!("\n{comments}"), 1)).unwrap();
    let form = format!("mesh=@{}", file.display());
    let upload = |headers: &[&str]| {
        let headers = headers.iter().flat_map(|header| ["-H", *header]);
        let arguments: Vec<&str> = ["-F", &form].into_iter().chain(headers).collect();
        ask("/api/search?geometry=false", &arguments)
    };
    let own = format!("Origin: https://{NAME}:{}", proxy.port);
    for (headers, expected) in [
        (&[][..], 200),
        (&[&*own], 200),
        (&[&*own, "Sec-Fetch-Site: same-origin"], 200),
        (&["Origin: https://evil.example"], 403),
        (&["Sec-Fetch-Site: cross-site"], 403),
    ] {
        let (status, answer) = upload(headers);
        assert_eq!(status, expected, "{headers:?}: {answer}");
    }
    // Another name that leads to the proxy, with its certificate accepted.
    assert_eq!(proxy.curl("evil.example", "/healthz", &["-k", "-u", USER]).0, 421);
}

#[test]
fn the_proxy_of_the_guide_allows_what_the_server_allows() {
    let (recipe, options) = (recipe(), ServeOptions::default());
    let number = |name: &str, unit: char| -> u64 {
        recipe.split_once(name).and_then(|(_, rest)| rest.split(unit).next()?.trim().parse().ok()).unwrap()
    };
    // nginx counts in powers of two, and the form around the file needs some space.
    assert!(number("client_max_body_size", 'm') << 20 > options.max_upload as u64 + (1 << 20));
    assert!(number("proxy_read_timeout", 's') > options.time_limit.as_secs() + 10);
}
