//! Serving the book: pages follow edits, and what stands in the way is said.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::small::SmallBook;

/// Generous, and there only to keep a broken server from hanging the tests.
const LIMIT: Duration = Duration::from_secs(60);

/// A running server, stopped when the test ends.
struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn start(book: &SmallBook) -> Server {
        let mut child = Command::new(env!("CARGO_BIN_EXE_press"))
            .args(["serve", "--port", "0", "--root"])
            .arg(book.root())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the press starts");
        let mut lines = BufReader::new(child.stderr.take().expect("its messages")).lines();
        let address = lines
            .find_map(|line| {
                let line = line.expect("a line");
                let (_, rest) = line.split_once("http://")?;
                Some(rest.split('/').next()?.to_owned())
            })
            .expect("an address");
        // Keep reading, so that the server never waits for its messages to be taken.
        std::thread::spawn(move || lines.for_each(drop));
        Server { child, address }
    }

    fn get(&self, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).expect("a connection");
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n",
            self.address
        )
        .expect("a request");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        answer
    }

    /// Asks for a page until it holds a text.
    fn wait_for(&self, path: &str, text: &str) {
        let start = Instant::now();
        while !self.get(path).contains(text) {
            assert!(start.elapsed() < LIMIT, "{path} never held {text:?}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended already.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

#[test]
fn a_saved_chapter_is_served_again() {
    let book = SmallBook::sound();
    let server = Server::start(&book);
    assert!(server.get("/one.html").contains("A sum"));
    let book = book.with("src/one.md", "A sum", "A total");
    server.wait_for("/one.html", "A total");
    assert!(server.get("/nothing.html").starts_with("HTTP/1.1 404"));
    drop(book);
}

#[test]
fn a_saved_exercise_and_a_saved_theme_are_served_again() {
    let hint = "::: {.hint title=\"a question\" text=\"../exercises/spec/hints.md:1\"}\n:::";
    let book = SmallBook::sound().with("src/one.md", "A sum", &format!("{hint}\n\nA sum"));
    let hints = "<!-- ANCHOR: 1 -->\nCount them.\n<!-- ANCHOR_END: 1 -->\n";
    book.write("exercises/spec/hints.md", hints);
    let book = book
        .with(
            "book.toml",
            "[output.html.playground]",
            "[output.html]\ntheme = \"press/theme\"\n\n[output.html.playground]",
        )
        .with("book.toml", "trust = true", "trust = true\nmacros = \"press/theme/macros.txt\"")
        .with("src/one.md", "c = a + b", "c = a + \\known{b}");
    book.write(
        "exhibits/accepted/one.toml",
        "[equations]\nsum = 'c = a + \\known{b}'\ndifference = 'd = a - b'\nproduct = 'e = a b'\n",
    );
    book.write("press/theme/macros.txt", "\\known:{\\mathbf{#1}}\n");
    book.write("press/theme/css/general.css", "main { color: red }");
    let server = Server::start(&book);
    assert!(server.get("/one.html").contains("Count them."));
    assert!(server.get("/one.html").contains("mathvariant=\"bold\""));
    let book = book.with("exercises/spec/hints.md", "Count", "Weigh");
    server.wait_for("/one.html", "Weigh them.");
    let book = book.with("press/theme/macros.txt", "mathbf", "mathsf");
    server.wait_for("/one.html", "mathvariant=\"sans-serif\"");
    let book = book.with("press/theme/css/general.css", "red", "green");
    let style = |page: &str| -> String {
        let at = page.find("css/general").expect("a style");
        page[at..].split('"').next().expect("an address").to_owned()
    };
    let start = Instant::now();
    while !server.get(&format!("/{}", style(&server.get("/one.html")))).contains("green") {
        assert!(start.elapsed() < LIMIT, "the old style is served");
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(book);
}

#[test]
fn a_saved_description_is_served_again() {
    let book = crate::library::book();
    let server = Server::start(&book);
    let page = "/api/small_sums/one/struct.Sum.html";
    assert!(server.get(page).contains("A sum that remembers"));
    let _book = book.with("code/src/one.rs", "A sum that remembers", "A sum that does not forget");
    server.wait_for(page, "A sum that does not forget");
}

#[test]
fn a_page_that_is_open_hears_of_faults_and_of_their_mending() {
    let book = SmallBook::sound().with("src/one.md", "@eq:sum of", "@eq:nothing of");
    let server = Server::start(&book);
    let mut stream = TcpStream::connect(&server.address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    write!(stream, "GET /__book-news HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
    let mut lines = BufReader::new(stream).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.contains("event: faults")));
    assert!(lines.any(|line| line.contains("@eq:nothing")));
    let _book = book.with("src/one.md", "@eq:nothing of", "@eq:sum of");
    assert!(lines.any(|line| line.contains("event: reload")));
}

#[test]
fn a_book_that_cannot_be_read_is_served_as_the_reason() {
    let book = SmallBook::sound().with("src/SUMMARY.md", "(one.md)", "(two.md)");
    let server = Server::start(&book);
    assert!(server.get("/").contains("two.md"));
    let _book = book.with("src/SUMMARY.md", "(two.md)", "(one.md)");
    server.wait_for("/one.html", "A sum");
}

#[test]
fn a_taken_port_is_said_with_what_to_do() {
    let book = SmallBook::sound();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = book.run(&["serve", "--port", &port]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && text.contains(&format!("port {port} is taken")), "{text}");
    assert!(text.contains("cargo book serve --port"), "{text}");
}

#[test]
fn a_folder_that_cannot_be_written_is_said_with_what_to_do() {
    let book = SmallBook::sound();
    book.write("src/generated", "a file where a folder should be");
    let output = book.run(&["build"]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && text.contains("cannot write"), "{text}");
    assert!(text.contains("make the folder writable"), "{text}");
}

#[test]
fn a_failed_build_leaves_the_last_good_book_alone() {
    let book = SmallBook::sound();
    assert!(book.run(&["build"]).status.success());
    let book = book.with("src/one.md", "@eq:sum of", "@eq:nothing of");
    assert!(!book.run(&["build"]).status.success());
    assert!(book.read("book/one.html").contains("A sum"));
}
