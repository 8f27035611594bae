//! A browser that is told what to do: Chromium without a window, spoken to over a pipe as its DevTools are.

use std::ffi::OsString;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::files;

/// Names under which systems install it.
const NAMES: [&str; 5] =
    ["chromium", "chromium-browser", "google-chrome-stable", "google-chrome", "chrome"];
/// The pages are our own, and where this runs without a person there is often no sandbox to be had. Nothing else is
/// loaded than what a page asks for, and nothing is kept.
const OPTIONS: [&str; 10] = [
    "--headless",
    "--remote-debugging-pipe",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
];
/// Chromium listens on descriptor 3 and answers on descriptor 4; a shell connects them.
const CONNECT: &str = r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >&2"#;

/// A running browser with one page.
pub struct Browser {
    process: Child,
    asks: ChildStdin,
    answers: BufReader<ChildStdout>,
    log: PathBuf,
    asked: u64,
    session: Option<String>,
}

impl Browser {
    /// Starts one that keeps what it needs in a folder.
    ///
    /// # Errors
    /// No Chromium, or one that does not start.
    pub fn start(profile: &Path) -> Result<Browser> {
        if cfg!(windows) {
            bail!(
                "the browser is connected by a Unix shell: run `cargo book pack` on Linux or macOS, or in WSL"
            );
        }
        files::remove(profile)?;
        let log = profile.join("log");
        files::write(&log, b"")?;
        let said = std::fs::File::create(&log)
            .with_context(|| format!("cannot write {}", log.display()))?;
        let mut folder = OsString::from("--user-data-dir=");
        folder.push(profile);
        let program = find()?;
        let mut process = Command::new("sh")
            .args(["-c", CONNECT])
            .arg(&program)
            .args(OPTIONS)
            .arg(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(said)
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let asks = process.stdin.take().context("the browser has no input")?;
        let answers = process.stdout.take().context("the browser has no output")?;
        let answers = BufReader::new(answers);
        let mut browser = Browser { process, asks, answers, log, asked: 0, session: None };
        let page = browser.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": page["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", attach)?;
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        browser.call("Page.enable", json!({}))?;
        Ok(browser)
    }

    /// Calls a method of the DevTools and waits for what it gives.
    ///
    /// # Errors
    /// What the browser says, or its last words when it has gone.
    pub fn call(&mut self, method: &str, parameters: Value) -> Result<Value> {
        self.asked += 1;
        let mut message = json!({ "id": self.asked, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        let sent = write!(self.asks, "{message}\0").and_then(|()| self.asks.flush());
        if sent.is_err() {
            bail!(self.last_words());
        }
        loop {
            let mut answer = self.next()?;
            if answer["id"] != json!(self.asked) {
                continue;
            }
            if let Some(error) = answer.get("error") {
                bail!("the browser refuses {method}: {}", error["message"]);
            }
            return Ok(answer["result"].take());
        }
    }

    /// Goes to a file and waits until all of it is loaded.
    pub fn open(&mut self, path: &Path) -> Result<()> {
        self.call("Page.navigate", json!({ "url": address(path)? }))?;
        self.evaluate(
            "new Promise(done => document.readyState === 'complete' ? done() : addEventListener('load', done))",
        )?;
        self.evaluate("document.fonts.ready.then(() => new Promise(requestAnimationFrame))")?;
        Ok(())
    }

    /// The value of an expression in the page; a promise is waited for.
    pub fn evaluate(&mut self, expression: &str) -> Result<Value> {
        let mut made = self.call(
            "Runtime.evaluate",
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true }),
        )?;
        if let Some(thrown) = made.get("exceptionDetails") {
            bail!("the page cannot be prepared: {}", thrown["exception"]["description"]);
        }
        Ok(made["result"]["value"].take())
    }

    /// The page as PDF, with an outline of its headings and with tags that say what is what.
    pub fn pdf(&mut self) -> Result<Vec<u8>> {
        let printed = self.call(
            "Page.printToPDF",
            json!({
                "preferCSSPageSize": true,
                "printBackground": true,
                "generateTaggedPDF": true,
                "generateDocumentOutline": true,
                "transferMode": "ReturnAsStream",
            }),
        )?;
        let stream = json!({ "handle": printed["stream"], "size": 1 << 22 });
        let mut bytes = Vec::new();
        loop {
            let part = self.call("IO.read", stream.clone())?;
            let text = part["data"].as_str().unwrap_or_default();
            match part["base64Encoded"] == json!(true) {
                true => bytes.extend(STANDARD.decode(text)?),
                false => bytes.extend(text.as_bytes()),
            }
            if part["eof"] == json!(true) {
                self.call("IO.close", json!({ "handle": printed["stream"] }))?;
                return Ok(bytes);
            }
        }
    }

    fn next(&mut self) -> Result<Value> {
        let mut message = Vec::new();
        let read = self.answers.read_until(0, &mut message);
        if read.is_err() || message.pop() != Some(0) {
            bail!(self.last_words());
        }
        serde_json::from_slice(&message).context("the browser answers what is no JSON")
    }

    fn last_words(&self) -> String {
        let log = std::fs::read(&self.log).unwrap_or_default();
        let log = String::from_utf8_lossy(&log).into_owned();
        let lines: Vec<&str> = log.lines().rev().take(5).collect();
        let lines: Vec<&str> = lines.into_iter().rev().collect();
        format!("the browser has gone; its last words were:\n{}", lines.join("\n"))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have gone by itself.
        drop(self.process.kill());
        drop(self.process.wait());
    }
}

/// The Chromium that `CHROMIUM` names, or the first one on the path.
fn find() -> Result<PathBuf> {
    if let Some(named) = std::env::var_os("CHROMIUM") {
        let named = PathBuf::from(named);
        if !named.is_file() {
            bail!("CHROMIUM names {}, which is no file", named.display());
        }
        return Ok(named);
    }
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    let candidates =
        NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let found = candidates.into_iter().find(|path| path.is_file());
    found.context("there is no Chromium: install it, or set CHROMIUM to its path")
}

/// The address of a file.
fn address(path: &Path) -> Result<String> {
    let path =
        dunce::canonicalize(path).with_context(|| format!("there is no {}", path.display()))?;
    let text = path.to_str().context("the path of the pages is not Unicode")?;
    let encoded = percent_encoding::utf8_percent_encode(text, PATH);
    Ok(format!("file://{encoded}"))
}

/// What a path may not hold in an address.
const PATH: &percent_encoding::AsciiSet = &percent_encoding::CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?');

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_any_name_has_an_address() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a #1? 100%.html");
        std::fs::write(&path, "").unwrap();
        assert!(address(&path).unwrap().ends_with("/a%20%231%3F%20100%25.html"));
    }
}
