//! From where a scene is looked at, and what stands beside it: rerun calls that a blueprint.

use nalgebra::Vector3;
use rerun::datatypes::Uuid;
use rerun::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, TimePanelBlueprint,
    ViewBlueprint, ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    BackgroundKind, ContainerKind, PanelState, PlayState,
};
use rerun::{Color, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

use crate::stage::coordinates;

/// A view beside the scene.
pub enum Beside {
    /// Curves over the timeline.
    Curves {
        /// Their title.
        title: &'static str,
        /// The entity above them.
        of: &'static str,
    },
    /// An image.
    Picture {
        /// Its title.
        title: &'static str,
        /// The entity above it.
        of: &'static str,
    },
}

/// A scene to the left, and views in a column to its right.
pub struct Layout {
    /// The title of the scene.
    pub title: &'static str,
    /// Where the reader's eye is, in metres.
    pub eye: Vector3<f64>,
    /// What it looks at.
    pub target: Vector3<f64>,
    /// Which way is up.
    pub up: Vector3<f64>,
    /// Metres between the lines of a floor through the origin, if there is one.
    pub floor: Option<f32>,
    /// The views beside.
    pub beside: Vec<Beside>,
    /// The timeline that is played.
    pub timeline: &'static str,
    /// Steps or seconds of it in a second of the reader's.
    pub speed: f64,
}

impl Layout {
    /// Adds the layout to a recording.
    pub(crate) fn send(
        &self,
        recording: &RecordingStream,
        name: &'static str,
    ) -> RecordingStreamResult<()> {
        let (stream, storage) =
            RecordingStreamBuilder::new(name).recording_id("layout").blueprint().memory()?;
        stream.set_time_sequence("blueprint", 0);
        let mut pages = Pages { stream, last: 0 };
        let scene = self.scene(&mut pages)?;
        let beside = self.beside.iter().map(|view| view.add(&mut pages));
        let beside = beside.collect::<RecordingStreamResult<Vec<_>>>()?;
        let shares = beside.iter().map(|_| 1.0).collect();
        let column = pages.container(ContainerKind::Vertical, &beside, shares)?;
        let root = pages.container(ContainerKind::Horizontal, &[scene, column], vec![2.2, 1.0])?;
        let viewport = ViewportBlueprint::new()
            .with_root_container(root.0)
            .with_auto_layout(false)
            .with_auto_views(false);
        pages.stream.log("viewport", &viewport)?;
        self.panels(&pages.stream)?;
        pages.stream.flush_blocking().ok();
        let messages = storage.take();
        let id = messages.iter().find_map(|message| match message {
            LogMsg::SetStoreInfo(info) => Some(info.info.store_id.clone()),
            _ => None,
        });
        if let Some(blueprint_id) = id {
            let activation =
                BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
            recording.send_blueprint(messages, activation);
        }
        Ok(())
    }

    fn scene(&self, pages: &mut Pages) -> RecordingStreamResult<Page> {
        let scene = pages.view("3D", self.title, "world")?;
        let eye = EyeControls3D::new()
            .with_position(coordinates(&self.eye))
            .with_look_target(coordinates(&self.target))
            .with_eye_up(coordinates(&self.up));
        pages.stream.log(format!("{}/EyeControls3D", scene.path()), &eye)?;
        let ground =
            Background::new(BackgroundKind::SolidColor).with_color(Color::from_rgb(17, 19, 25));
        pages.stream.log(format!("{}/Background", scene.path()), &ground)?;
        let floor = LineGrid3D::new().with_visible(self.floor.is_some());
        let floor = match self.floor {
            Some(metres) => floor.with_spacing(metres),
            None => floor,
        };
        pages.stream.log(format!("{}/LineGrid3D", scene.path()), &floor)?;
        Ok(scene)
    }

    fn panels(&self, stream: &RecordingStream) -> RecordingStreamResult<()> {
        let hidden = PanelBlueprint::new().with_state(PanelState::Hidden);
        stream.log("blueprint_panel", &hidden)?;
        stream.log("selection_panel", &hidden)?;
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(self.timeline)
            .with_play_state(PlayState::Following)
            .with_fps(self.speed)
            .with_playback_speed(1.0);
        stream.log("time_panel", &time)
    }
}

impl Beside {
    fn add(&self, pages: &mut Pages) -> RecordingStreamResult<Page> {
        match self {
            Self::Curves { title, of } => pages.view("TimeSeries", title, of),
            Self::Picture { title, of } => pages.view("2D", title, of),
        }
    }
}

/// What a layout consists of, with names that are always the same.
struct Pages {
    stream: RecordingStream,
    last: u128,
}

/// A view or a container.
#[derive(Clone, Copy)]
struct Page(Uuid, &'static str);

impl Page {
    fn path(self) -> String {
        format!("{}/{}", self.1, self.0)
    }
}

impl Pages {
    fn page(&mut self, kind: &'static str) -> Page {
        self.last += 1;
        Page(Uuid { bytes: self.last.to_be_bytes() }, kind)
    }

    fn view(&mut self, class: &str, title: &str, origin: &str) -> RecordingStreamResult<Page> {
        let page = self.page("view");
        let view = ViewBlueprint::new(class).with_display_name(title).with_space_origin(origin);
        self.stream.log(page.path(), &view)?;
        let contents = ViewContents::new(["$origin/**"]);
        self.stream.log(format!("{}/ViewContents", page.path()), &contents)?;
        Ok(page)
    }

    fn container(
        &mut self,
        kind: ContainerKind,
        pages: &[Page],
        shares: Vec<f32>,
    ) -> RecordingStreamResult<Page> {
        let page = self.page("container");
        let container = ContainerBlueprint::new(kind)
            .with_contents(pages.iter().map(|page| page.path()).collect::<Vec<_>>());
        let container = match kind {
            ContainerKind::Vertical => container.with_row_shares(shares),
            _ => container.with_col_shares(shares),
        };
        self.stream.log(page.path(), &container)?;
        Ok(page)
    }
}
