#![cfg(target_os = "linux")]
//! The window under Xvfb, as a user has it: it opens, takes clicks and keys, is resized, and closes. Needs Xvfb, xdotool and
//! ImageMagick's import; says that it skips without them, and fails instead where GLINT_REQUIRE_ADAPTER is set.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything that should happen.
const PATIENCE: Duration = Duration::from_secs(90);
const SCREEN: [usize; 2] = [1280, 720];

/// A process that ends with its owner.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// The program in a window on a display of its own.
struct Session {
    program: Running,
    /// What it says.
    log: tempfile::NamedTempFile,
    display: String,
    window: String,
    _server: Running,
}

/// `None` where a tool is missing and tests may skip.
fn tools() -> Option<()> {
    let missing =
        |tool: &&str| Command::new(tool).arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_err();
    let tool = ["Xvfb", "xdotool", "import"].into_iter().find(|tool| missing(tool))?;
    let message = format!("{tool} is missing; apt install xvfb xauth xdotool imagemagick");
    assert!(std::env::var_os("GLINT_REQUIRE_ADAPTER").is_none(), "{message}");
    eprintln!("skipped: {message}");
    Some(())
}

/// The example beside this test.
fn program() -> PathBuf {
    let mut path = std::env::current_exe().unwrap();
    path.pop();
    path.pop();
    path.push("examples/window");
    assert!(path.exists(), "{} is not built; run cargo build -p glint-view-core --example window", path.display());
    path
}

/// Calls `ready` until it gives something, or for long enough.
fn wait_for<T>(mut ready: impl FnMut() -> Option<T>) -> Option<T> {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(found) = ready() {
            return Some(found);
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    None
}

impl Session {
    fn start(flags: &[&str]) -> Session {
        let size = format!("{}x{}x24", SCREEN[0], SCREEN[1]);
        let mut server = Command::new("Xvfb")
            // Without -noreset the server starts anew whenever its last client, which may be xdotool, has gone, and
            // refuses whoever comes at that moment.
            .args(["-displayfd", "1", "-screen", "0", &size, "-nolisten", "tcp", "-noreset"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let server = Running(server);
        let display = format!(":{}", number.trim());
        let log = tempfile::NamedTempFile::new().unwrap();
        let program = Command::new(program())
            .args(flags)
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stderr(log.reopen().unwrap())
            .spawn()
            .unwrap();
        Session { program: Running(program), log, display, window: String::new(), _server: server }
    }

    /// Waits for the window, gives it the keyboard, and waits for its first picture.
    fn opened(mut self) -> Session {
        self.window = self.wait_for("a window", || {
            let found = self.xdotool(&["search", "--name", "^glint-view$"]);
            found.lines().next().map(str::to_owned)
        });
        self.xdotool(&["windowfocus", &self.window]);
        self.wait_for("a picture", || self.screen().iter().any(|&byte| byte > 0).then_some(()));
        self.settled();
        self
    }

    /// Calls `ready` until it gives something; what the program said if it does not.
    fn wait_for<T>(&self, what: &str, ready: impl FnMut() -> Option<T>) -> T {
        wait_for(ready).unwrap_or_else(|| {
            let said = std::fs::read_to_string(self.log.path()).unwrap_or_default();
            panic!("waited in vain for {what}; the program said: {said}")
        })
    }

    fn xdotool(&self, words: &[&str]) -> String {
        let output = Command::new("xdotool").args(words).env("DISPLAY", &self.display).output().unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// RGB of the screen.
    fn screen(&self) -> Vec<u8> {
        let words = ["-window", "root", "-depth", "8", "rgb:-"];
        let output = Command::new("import").args(words).env("DISPLAY", &self.display).output().unwrap();
        assert_eq!(output.stdout.len(), SCREEN[0] * SCREEN[1] * 3, "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    }

    /// The screen once it stays the same for a moment.
    fn settled(&self) -> Vec<u8> {
        let mut last = self.screen();
        let mut since = Instant::now();
        self.wait_for("a screen that stands still", || {
            let next = self.screen();
            if next != last {
                since = Instant::now();
                last = next;
            }
            (since.elapsed() > Duration::from_millis(800)).then_some(())
        });
        last
    }

    /// The screen once `part` of it is another than in `before`.
    fn changed(&self, what: &str, before: &[u8], part: fn(usize, usize) -> bool) -> Vec<u8> {
        self.wait_for(what, || (count(before, &self.screen(), part) > 50).then_some(()));
        self.settled()
    }

    /// The same, where a busy machine may be late to know where the mouse is: tried again every few seconds.
    fn changed_by_mouse(&self, what: &str, before: &[u8], act: impl Fn()) -> Vec<u8> {
        self.wait_for(what, || {
            act();
            std::thread::sleep(Duration::from_secs(2));
            (count(before, &self.screen(), scene) > 50).then_some(())
        });
        self.settled()
    }

    /// Waits until `part` of the screen is as in `expected`.
    fn becomes(&self, what: &str, expected: &[u8], part: fn(usize, usize) -> bool) {
        self.wait_for(what, || (count(expected, &self.screen(), part) == 0).then_some(()));
    }

    fn key(&self, key: &str) {
        self.xdotool(&["key", key]);
    }

    /// Presses the mouse button at one place and releases it at another, as slowly as by hand.
    fn drag(&self, from: [u32; 2], to: [u32; 2]) {
        let steps: [&[&str]; 4] = [
            &["mousemove", &from[0].to_string(), &from[1].to_string()],
            &["mousedown", "1"],
            &["mousemove", &to[0].to_string(), &to[1].to_string()],
            &["mouseup", "1"],
        ];
        for step in steps {
            self.xdotool(step);
            std::thread::sleep(Duration::from_millis(250));
        }
    }

    /// How the program ended, and what it said.
    fn ended(mut self) -> (ExitStatus, String) {
        let status = wait_for(|| self.program.0.try_wait().unwrap());
        let said = std::fs::read_to_string(self.log.path()).unwrap();
        (status.unwrap_or_else(|| panic!("the program goes on; it said: {said}")), said)
    }
}

/// Pixels of a part of the screen that differ.
fn count(a: &[u8], b: &[u8], part: fn(usize, usize) -> bool) -> usize {
    let pixels = a.chunks_exact(3).zip(b.chunks_exact(3)).enumerate();
    pixels.filter(|(i, (a, b))| a != b && part(i % SCREEN[0], i / SCREEN[0])).count()
}

/// Right of the panel.
fn scene(x: usize, _: usize) -> bool {
    x > 400
}

/// Where the panel is.
fn panel(x: usize, _: usize) -> bool {
    x < 330
}

#[test]
fn it_opens_takes_clicks_keys_and_the_mouse_and_closes_on_escape() {
    if tools().is_some() {
        return;
    }
    let session = Session::start(&[]).opened();
    let smooth = session.settled();
    // The second of the methods, at the panel's upper edge.
    let click = || session.drag([23, 83], [23, 83]);
    let dictionary = session.changed_by_mouse("glints after a click", &smooth, click);
    session.key("1");
    session.becomes("the smooth BRDF after its key", &smooth, scene);
    assert!(count(&dictionary, &session.screen(), scene) > 50);
    session.key("o");
    session.changed("false colours", &smooth, scene);
    // Level of detail, look-ups, operations, none.
    for _ in 0..4 {
        session.key("o");
    }
    session.becomes("the picture without false colours", &smooth, scene);
    let shown = session.settled();
    session.key("h");
    session.changed("a hidden panel", &shown, panel);
    session.key("h");
    session.becomes("the panel", &shown, panel);
    // A drag beside the panel orbits, the wheel zooms, F goes back.
    let turned = session.changed_by_mouse("a turned camera", &smooth, || session.drag([800, 300], [900, 350]));
    let wheel = || {
        session.xdotool(&["click", "4"]);
    };
    session.changed_by_mouse("a nearer camera", &turned, wheel);
    session.key("f");
    session.becomes("the camera of the beginning", &smooth, scene);
    session.key("Escape");
    let (status, said) = session.ended();
    assert_eq!(status.code(), Some(0), "{said}");
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn it_lives_through_sizes_down_to_a_pixel_and_closes_with_its_window() {
    if tools().is_some() {
        return;
    }
    let session = Session::start(&[]).opened();
    for size in [["400", "300"], ["1", "1"], ["37", "700"], ["1280", "3"], ["1000", "600"]] {
        session.xdotool(&["windowsize", &session.window, size[0], size[1]]);
        std::thread::sleep(Duration::from_millis(700));
    }
    let geometry = session.xdotool(&["getwindowgeometry", &session.window]);
    assert!(geometry.contains("1000x600"), "{geometry}");
    let lit = |screen: &[u8]| {
        screen.chunks_exact(3).enumerate().filter(|(i, rgb)| scene(i % SCREEN[0], 0) && rgb[0] > 128).count()
    };
    session.wait_for("the scene in its last size", || (lit(&session.screen()) > 100).then_some(()));
    session.key("q");
    let (status, said) = session.ended();
    assert_eq!(status.code(), Some(0), "{said}");
}

#[test]
fn it_closes_when_the_window_manager_asks() {
    if tools().is_some() {
        return;
    }
    let session = Session::start(&[]).opened();
    delete_window(&session);
    let (status, said) = session.ended();
    assert_eq!(status.code(), Some(0), "{said}");
}

/// Sends WM_DELETE_WINDOW as window managers do (ICCCM, section 4.2.8.1).
fn delete_window(session: &Session) {
    use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};
    let (connection, _) = x11rb::connect(Some(&session.display)).unwrap();
    let atom = |name: &str| connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
    let window: u32 = session.window.parse().unwrap();
    let data = [atom("WM_DELETE_WINDOW"), 0, 0, 0, 0];
    let message = ClientMessageEvent::new(32, window, atom("WM_PROTOCOLS"), data);
    connection.send_event(false, window, EventMask::NO_EVENT, message).unwrap();
    // An answer to a later request: the server has taken the message before the connection ends.
    connection.get_input_focus().unwrap().reply().unwrap();
}

#[test]
fn it_ends_after_the_frames_that_a_test_asks_for() {
    if tools().is_some() {
        return;
    }
    let (status, said) = Session::start(&["--frames", "3"]).ended();
    assert_eq!(status.code(), Some(0), "{said}");
}

#[test]
fn it_goes_on_with_a_new_device_and_gives_up_after_three_losses() {
    if tools().is_some() {
        return;
    }
    let (status, said) = Session::start(&["--frames", "8", "--lose", "2", "--lose", "4"]).ended();
    assert_eq!(status.code(), Some(0), "{said}");
    let (status, said) = Session::start(&["--frames", "9", "--lose", "1", "--lose", "2", "--lose", "3"]).ended();
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(said.contains("was lost 3 times"), "{said}");
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn without_a_display_it_says_what_to_do() {
    let mut program = Command::new(program());
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        program.env_remove(variable);
    }
    let output = program.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("no window can be opened") && said.contains("--headless"), "{said}");
}
