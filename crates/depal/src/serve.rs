//! `depal serve`: the vision server of a scene, for clients that come over TCP.

use std::fs::File;
use std::io::Write as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use depal_cell::spec::CellSpec;
use depal_cell::station::{Errands, Station, StationReply};
use depal_interface::PortSettings;
use depal_net::journal::{FORMAT, Header, Journal, Recorded, read};
use depal_net::{Limits, Listen, NetError, Stop, compute_at_once, compute_on_thread, open, replay};
use serde_json::json;

use crate::ServeArgs;
use crate::failure::Failure;
use crate::listen::{Kind, Port, parse_listens};
use crate::run::{explain, faults, load_scene, wall_seconds};
use crate::serve_log::ServeLog;

/// Beside the gripper and above its cups; all else as it is by itself.
const BOARD: &str = "calibration.xyz_mm=[560, 0, 240]";

/// Serves until told to stop, or replays a journal.
pub fn serve(args: &ServeArgs) -> Result<(), Failure> {
    if args.replay.is_some() {
        return answer_again(args);
    }
    let mut listens = parse_listens(&args.listen)?;
    let mut spec = cell_spec(args.scene.as_ref(), &args.set)?;
    spec.interface.faults.extend(faults(&args.inject)?);
    if listens.is_empty() {
        let address = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), spec.port);
        listens.push(match spec.plc.take() {
            Some(plc) => Port::plc(&plc, address),
            None => Port::commands(Kind::of_port(&own_port(&spec)), address),
        });
    }
    let wanted: Vec<Listen> = listens.iter().map(|port| port.listen).collect();
    let ports = open(&wanted).map_err(environment)?;
    let kinds: Vec<Kind> = listens.iter().map(|port| port.kind).collect();
    open_sessions(&mut spec, &kinds);

    let journal = open_journal(args, &spec, &kinds)?;
    let errands = compute_on_thread().map_err(environment)?;
    let station = station(spec, errands)?;

    let names: Vec<String> = kinds
        .iter()
        .zip(ports.addresses())
        .map(|(kind, address)| format!("{}:{}", kind.name(), address.port()))
        .collect();
    announce(args, &kinds, ports.addresses())?;
    let log = ServeLog::start(names, args.verbose)?;
    let notices = log.notices();
    let served = depal_net::serve(
        ports,
        station,
        Limits::default(),
        notices,
        journal,
        Stop::on_signals(),
    );
    log.finish();
    served.map_err(environment)
}

/// A client may want to calibrate whatever the scene is for: where it says nothing, a board hangs on the flange
/// while command 701 is under way, if the arm can show it to the camera.
fn cell_spec(file: Option<&PathBuf>, set: &[String]) -> Result<CellSpec, Failure> {
    let file = file.map(PathBuf::as_path);
    let scene = load_scene(file, set, None)?;
    if scene.calibration.is_none() {
        let with_board = [set, &[BOARD.to_owned()]].concat();
        if let Ok(spec) = load_scene(file, &with_board, None)?.cell_spec()
            && !spec.is_eye_in_hand()
        {
            return Ok(spec);
        }
    }
    scene
        .cell_spec()
        .map_err(|error| Failure::Input(explain(&error)))
}

/// The settings of the scene's own port.
fn own_port(spec: &CellSpec) -> PortSettings {
    spec.interface.ports.first().cloned().unwrap_or_default()
}

/// One session for each kind; all else as the scene says.
fn open_sessions(spec: &mut CellSpec, kinds: &[Kind]) {
    let own = own_port(spec);
    spec.interface.ports = kinds.iter().map(|kind| kind.session(&own)).collect();
}

fn station(spec: CellSpec, errands: Errands) -> Result<Station, Failure> {
    Station::new(spec, wall_seconds, errands).map_err(|error| Failure::Input(error.to_string()))
}

fn open_journal(
    args: &ServeArgs,
    spec: &CellSpec,
    kinds: &[Kind],
) -> Result<Option<Journal>, Failure> {
    let Some(path) = &args.journal else {
        return Ok(None);
    };
    let header = Header {
        journal: FORMAT,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: spec.scene.clone(),
        file: args
            .scene
            .as_ref()
            .map(|file| file.to_string_lossy().into_owned()),
        set: args.set.clone(),
        inject: args.inject.clone(),
        ports: kinds.iter().map(|kind| kind.name().to_owned()).collect(),
    };
    let failed = |error: std::io::Error| {
        Failure::Environment(format!(
            "cannot write the journal {}: {error}",
            path.display()
        ))
    };
    let file = File::create(path).map_err(failed)?;
    let journal = Journal::start(Box::new(file), &header).map_err(failed)?;
    Ok(Some(journal))
}

/// The ready line.
fn announce(args: &ServeArgs, kinds: &[Kind], addresses: &[SocketAddr]) -> Result<(), Failure> {
    let listening = || kinds.iter().zip(addresses);
    for (kind, address) in listening() {
        let does = if *kind == Kind::S7 {
            "polls the PLC at"
        } else {
            "on"
        };
        tell!("{} {does} {address}", kind.name());
    }
    let is_text = |kind: &Kind| matches!(kind, Kind::Commands(encoding) if !encoding.is_hex());
    if let Some((_, address)) = listening().find(|(kind, _)| is_text(kind)) {
        let (host, port) = (address.ip(), address.port());
        tell!("try: nc {host} {port}, then type 901; Ctrl-C ends the server");
    }
    if args.json {
        let list: Vec<_> = listening()
            .map(|(kind, address)| json!({"kind": kind.name(), "addr": address.to_string()}))
            .collect();
        let mut out = std::io::stdout();
        writeln!(out, "{}", json!({ "listening": list }))
            .and_then(|()| out.flush())
            .map_err(|error| Failure::Environment(format!("cannot write to stdout: {error}")))?;
    }
    Ok(())
}

fn environment(error: NetError) -> Failure {
    let help = match &error {
        NetError::Listen { source, .. } if source.kind() == std::io::ErrorKind::AddrInUse => {
            "\nhelp: another program listens there; end it, or take another port with --listen KIND=ADDR:PORT"
        }
        NetError::Listen { .. } => "\nhelp: choose another address with --listen KIND=ADDR:PORT",
        _ => "",
    };
    Failure::Environment(format!("{error}{help}"))
}

/// `--replay FILE`.
fn answer_again(args: &ServeArgs) -> Result<(), Failure> {
    let recorded = load_journal(args)?;
    let header = &recorded.header;
    let recorded_file = header.file.as_ref().map(PathBuf::from);
    let mut set = header.set.clone();
    set.extend(args.set.iter().cloned());
    let mut spec = cell_spec(args.scene.as_ref().or(recorded_file.as_ref()), &set)?;
    spec.interface.faults.extend(faults(&header.inject)?);
    spec.interface.faults.extend(faults(&args.inject)?);
    if spec.scene != header.scene {
        return Err(Failure::Input(format!(
            "the journal is of scene {:?}, and this is {:?}",
            header.scene, spec.scene
        )));
    }
    let kinds = header
        .ports
        .iter()
        .map(|kind| {
            Kind::from_name(kind)
                .ok_or_else(|| Failure::Input(format!("the journal has a port of kind {kind:?}")))
        })
        .collect::<Result<Vec<_>, _>>()?;
    open_sessions(&mut spec, &kinds);
    let mut station = station(spec, compute_at_once())?;
    let replayed = replay(&mut station, &recorded.entries);
    if args.json {
        let difference = replayed.difference.as_ref().map(|difference| {
            json!({
                "line": difference.entry + 2,
                "recorded": difference.recorded.as_ref().map(describe),
                "given": difference.given.as_ref().map(describe),
            })
        });
        say!(
            "{}",
            json!({"replies": replayed.replies, "equal": difference.is_none(), "difference": difference})
        );
    }
    match &replayed.difference {
        None => {
            tell!("{} replies, all as recorded", replayed.replies);
            Ok(())
        }
        Some(difference) => {
            let said = |reply: &Option<StationReply>| {
                reply.as_ref().map_or("nothing".to_owned(), describe)
            };
            tell!(
                "line {}: after {} equal replies\n  recorded: {}\n  now:      {}",
                difference.entry + 2,
                replayed.replies,
                said(&difference.recorded),
                said(&difference.given)
            );
            Err(Failure::NotAccepted)
        }
    }
}

fn load_journal(args: &ServeArgs) -> Result<Recorded, Failure> {
    let path = args.replay.clone().unwrap_or_default();
    let text = std::fs::read_to_string(&path).map_err(|error| Failure::unread(&path, error))?;
    read(&text).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

fn describe(reply: &StationReply) -> String {
    format!(
        "tick {}, port {}, client {}: {}",
        reply.tick,
        reply.port.0,
        reply.connection.0,
        reply.bytes.escape_ascii()
    )
}
