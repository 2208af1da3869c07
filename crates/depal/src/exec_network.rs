//! What lies behind the sockets of `depal exec`: real ones, recorded if asked for, or a record of them.

use std::time::Duration;

use depal_controller::{Network, RecordingNetwork, ReplayNetwork, Transcript};
use depal_net::robot_sockets::RobotSockets;

use crate::exec::ExecArgs;
use crate::failure::Failure;
use crate::task_folder::read;

/// Real sockets or a transcript.
pub enum ProgramNetwork {
    /// Of this computer.
    Real(RobotSockets),
    /// Of this computer, written down.
    Recorded(RecordingNetwork<RobotSockets>),
    /// The other side of a transcript.
    Replay(ReplayNetwork),
}

impl ProgramNetwork {
    /// As the arguments ask.
    pub fn open(args: &ExecArgs) -> Result<Self, Failure> {
        let Some(path) = &args.replay_sockets else {
            let sockets = RobotSockets::new(args.connect.clone());
            return Ok(match &args.record_sockets {
                None => Self::Real(sockets),
                Some(_) => Self::Recorded(RecordingNetwork::new(sockets)),
            });
        };
        let text = depal_rapid::decode(&read(path)?);
        let transcript = Transcript::parse(&text).map_err(|error| {
            Failure::Input(format!(
                "{}:{}: {}",
                path.display(),
                error.line,
                error.message
            ))
        })?;
        Ok(Self::Replay(ReplayNetwork::new(&transcript)))
    }

    /// For the controller.
    pub fn as_network(&mut self) -> &mut dyn Network {
        match self {
            Self::Real(sockets) => sockets,
            Self::Recorded(recording) => recording,
            Self::Replay(replay) => replay,
        }
    }

    /// Lets the wall clock catch up while a real socket is waited for.
    pub fn wait(&mut self, limit: Duration) {
        let sockets = match self {
            Self::Real(sockets) => sockets,
            Self::Recorded(recording) => recording.inner_mut(),
            Self::Replay(_) => return,
        };
        if sockets.is_waiting() {
            sockets.wait(limit);
        }
    }

    /// Writes the record, or tells what was otherwise than in it.
    pub fn close(&self, args: &ExecArgs) -> Result<(), Failure> {
        match self {
            Self::Replay(replay) => {
                if let Some(difference) = replay.difference() {
                    tell!("not as in the transcript: {difference}");
                }
                Ok(())
            }
            Self::Real(_) => Ok(()),
            Self::Recorded(recording) => match &args.record_sockets {
                None => Ok(()),
                Some(path) => {
                    std::fs::write(path, recording.transcript().to_text()).map_err(|error| {
                        Failure::Environment(format!("cannot write {}: {error}", path.display()))
                    })
                }
            },
        }
    }
}
