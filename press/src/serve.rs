//! Serves the book and builds it anew whenever something it is made from changes.

use std::convert::Infallible;
use std::io::ErrorKind;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use axum::Router;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::http::header::CACHE_CONTROL;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use maud::{DOCTYPE, PreEscaped, html};
use notify::{RecursiveMode, Watcher};
use tokio::net::TcpListener;
use tokio::sync::broadcast;
use tokio_stream::StreamExt;
use tokio_stream::wrappers::BroadcastStream;
use tower_http::services::ServeDir;

use crate::answers::Answers;
use crate::fault::Faults;
use crate::make::Maker;
use crate::settings::Layout;

/// Where a page listens for news of the book.
const NEWS: &str = "__book-news";

/// Editors write a file in several steps; what comes within this time is one change.
const PAUSE: Duration = Duration::from_millis(80);

/// What the book is made from: its pages and what they include, the program and the library, the theme.
const WATCHED: [&str; 12] = [
    "src",
    "code",
    "exhibits",
    "factrs",
    "exercises",
    "widgets",
    "recordings",
    "grader/recipes",
    "press/theme",
    "book.toml",
    "Cargo.toml",
    "Cargo.lock",
];

/// What is served, and who is told when it changes.
#[derive(Clone)]
struct Served {
    site: Arc<RwLock<Option<PathBuf>>>,
    trouble: Arc<RwLock<String>>,
    /// The chapter that was asked for last.
    viewed: Arc<RwLock<String>>,
    /// Whether something changed since the build began.
    changed: Arc<AtomicBool>,
    news: broadcast::Sender<News>,
}

#[derive(Clone)]
enum News {
    Reload,
    Faults(String),
}

/// Builds the book, serves it on `port` of this machine and goes on until it is stopped.
pub fn serve(maker: &Maker, port: u16, open: bool) -> Result<()> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(1)
        .enable_all()
        .build()
        .context("cannot start the server")?;
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let listener = match runtime.block_on(TcpListener::bind(address)) {
        Ok(listener) => listener,
        Err(error) if error.kind() == ErrorKind::AddrInUse => {
            bail!(
                "port {port} is taken by another program: stop that, or choose another port with `cargo book serve --port {}`",
                port.wrapping_add(1).max(1024)
            );
        }
        Err(error) => {
            return Err(error).with_context(|| {
                format!("cannot listen on port {port}: choose another with --port")
            });
        }
    };
    let address = listener.local_addr()?;
    let served = Served {
        site: Arc::default(),
        trouble: Arc::default(),
        viewed: Arc::default(),
        changed: Arc::default(),
        news: broadcast::channel(16).0,
    };
    let (sender, changes) = channel();
    let (layout, changed) = (maker.layout.clone(), served.changed.clone());
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        if let Some(path) = changed_file(&layout, event) {
            changed.store(true, Ordering::SeqCst);
            // The receiver goes away only when the program ends.
            drop(sender.send(path));
        }
    })
    .context("cannot watch the files of the book")?;
    for folder in WATCHED {
        let path = maker.layout.root.join(folder);
        if path.exists() {
            watcher
                .watch(&path, RecursiveMode::Recursive)
                .with_context(|| format!("cannot watch {}", path.display()))?;
        }
    }
    build(maker, &served);
    maker.steps.say(&format!("\n  The book is at http://{address}/ — stop with Ctrl-C.\n"));
    if open {
        opener::open_browser(format!("http://{address}/"))
            .context("cannot open a browser: open the address above yourself")?;
    }
    let router = Router::new()
        .route(&format!("/{NEWS}"), get(news))
        .fallback(get(page))
        .with_state(served.clone());
    runtime.spawn(async move { axum::serve(listener, router).await });
    follow_answers(maker, &served);
    watch(maker, &served, &changes)
}

/// Builds after every change, for ever.
fn watch(maker: &Maker, served: &Served, changes: &Receiver<PathBuf>) -> Result<()> {
    loop {
        let mut changed = vec![changes.recv().context("the files are watched no more")?];
        loop {
            match changes.recv_timeout(PAUSE) {
                Ok(path) => changed.push(path),
                Err(RecvTimeoutError::Timeout) => break,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
        }
        served.changed.store(false, Ordering::SeqCst);
        let last = changed.last().map(|path| path.display().to_string()).unwrap_or_default();
        maker.steps.say(&format!("\n{last} changed"));
        let answers = Answers::new(&maker.layout);
        // No page says what an answer says.
        if !maker.mine || !changed.iter().all(|path| answers.is_answer(path)) {
            build(maker, served);
        }
        follow_answers(maker, served);
    }
}

/// The file an event is about, unless the build itself wrote it.
fn changed_file(layout: &Layout, event: notify::Result<notify::Event>) -> Option<PathBuf> {
    let event = event.ok().filter(|event| {
        event.kind.is_create() || event.kind.is_modify() || event.kind.is_remove()
    })?;
    let written = [layout.generated(), layout.api()];
    let foreign = |path: &PathBuf| !written.iter().any(|folder| path.starts_with(folder));
    let seen = |path: PathBuf| match path.strip_prefix(&layout.root) {
        Ok(path) => path.to_path_buf(),
        Err(_) => path,
    };
    event.paths.into_iter().filter(foreign).map(seen).find(|path| !is_scratch(path))
}

/// Whether an editor keeps the file for itself, or a program in a hidden folder.
fn is_scratch(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let hidden = path.iter().any(|part| part.to_string_lossy().starts_with('.'));
    hidden || name.ends_with('~') || name.ends_with(".swp") || name == "4913"
}

/// Builds beside the pages that are being served, and puts the new ones in their place.
fn build(maker: &Maker, served: &Served) {
    let start = Instant::now();
    let trouble = match try_build(maker, served, start) {
        Ok(faults) => faults.report(),
        Err(error) => {
            drop(served.news.send(News::Reload));
            format!("{error:#}\n")
        }
    };
    eprint!("{trouble}");
    maker.steps.say(&format!("built in {:.1} s", start.elapsed().as_secs_f64()));
    served.tell(trouble);
}

/// Compiles answers that changed and shows them, where they are to be shown.
fn follow_answers(maker: &Maker, served: &Served) {
    let Some(site) = served.current().filter(|_| maker.mine) else { return };
    match maker.refresh_answers(&site) {
        Ok(true) => served.show(site, true),
        Ok(false) => {}
        Err(error) => served.tell(format!("{error:#}\n")),
    }
}

/// Builds what somebody looks at, and then the rest, unless something changes before that.
fn try_build(maker: &Maker, served: &Served, start: Instant) -> Result<Faults> {
    let mut reload = true;
    if served.current().is_some() {
        let site = served.free(maker);
        let viewed = served.viewed.read().unwrap_or_else(PoisonError::into_inner).clone();
        let (faults, rest) = maker.build_first(&site, NEWS, &viewed)?;
        served.show(site, true);
        maker.steps.say(&format!("shown after {:.1} s", start.elapsed().as_secs_f64()));
        if served.changed.load(Ordering::SeqCst) {
            return Ok(faults);
        }
        // With exhibits that are to be computed, faults may be those of old ones.
        if !rest {
            served.tell(faults.report());
        }
        reload = rest;
    }
    let site = served.free(maker);
    maker.build_live(&site, NEWS, || served.show(site.clone(), reload))
}

impl Served {
    fn current(&self) -> Option<PathBuf> {
        self.site.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The folder whose pages are not being served.
    fn free(&self, maker: &Maker) -> PathBuf {
        let first = self.current().is_none_or(|site| !site.ends_with("serve-a"));
        maker.layout.work().join(if first { "serve-a" } else { "serve-b" })
    }

    /// Serves the pages in a folder; whoever reads is to load them when they changed.
    fn show(&self, site: PathBuf, reload: bool) {
        *self.site.write().unwrap_or_else(PoisonError::into_inner) = Some(site);
        if reload {
            // What was wrong before is not what is wrong now, and that is not known yet.
            self.trouble.write().unwrap_or_else(PoisonError::into_inner).clear();
            // Nobody may be listening, which is no error.
            drop(self.news.send(News::Reload));
        }
    }

    /// Tells what is wrong, unless everybody knows.
    fn tell(&self, trouble: String) {
        let mut known = self.trouble.write().unwrap_or_else(PoisonError::into_inner);
        if *known != trouble {
            known.clone_from(&trouble);
            let news = if trouble.is_empty() { News::Reload } else { News::Faults(trouble) };
            drop(self.news.send(news));
        }
    }
}

/// A stream of what happens to the book; whoever comes late is told of the faults there are.
async fn news(State(served): State<Served>) -> impl IntoResponse {
    let trouble = served.trouble.read().unwrap_or_else(PoisonError::into_inner).clone();
    let first = (!trouble.is_empty()).then_some(News::Faults(trouble));
    let later = BroadcastStream::new(served.news.subscribe()).filter_map(Result::ok);
    let events = tokio_stream::iter(first).chain(later).map(|news| {
        Ok::<_, Infallible>(match news {
            News::Reload => Event::default().event("reload").data("reload"),
            News::Faults(text) => Event::default().event("faults").data(text),
        })
    });
    Sse::new(events).keep_alive(KeepAlive::default())
}

/// A file of the book.
async fn page(State(served): State<Served>, request: Request) -> Response {
    if let Some(page) = request.uri().path().strip_suffix(".html") {
        let slug = page.rsplit('/').next().unwrap_or_default();
        slug.clone_into(&mut served.viewed.write().unwrap_or_else(PoisonError::into_inner));
    }
    let Some(site) = served.current() else {
        let trouble = served.trouble.read().unwrap_or_else(PoisonError::into_inner).clone();
        let again = format!(
            "new EventSource('/{NEWS}').addEventListener('reload', () => location.reload())"
        );
        let page = html! {
            (DOCTYPE) title { "The book cannot be built" } pre { (trouble) } script { (PreEscaped(again)) }
        };
        return (StatusCode::INTERNAL_SERVER_ERROR, Html(page.into_string())).into_response();
    };
    match ServeDir::new(&site).try_call(request).await {
        Ok(found) if found.status() != StatusCode::NOT_FOUND => {
            // What a page loads may be another one by now.
            ([(CACHE_CONTROL, "no-store")], found).into_response()
        }
        Err(error) if error.kind() != ErrorKind::NotFound => {
            (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()).into_response()
        }
        _ => {
            let page = std::fs::read_to_string(site.join("404.html"));
            let page = page.unwrap_or_else(|_| "There is no such page.".to_owned());
            (StatusCode::NOT_FOUND, Html(page)).into_response()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_tests_and_editors_keep_is_no_change_of_the_book() {
        for path in
            ["exercises/.progress/ring.verdicts", "src/.ring.md.swp", "src/ring.md~", "src/4913"]
        {
            assert!(is_scratch(Path::new(path)), "{path}");
        }
        assert!(!is_scratch(Path::new("exercises/src/ring.rs")));
    }
}
