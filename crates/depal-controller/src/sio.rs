use crate::configuration::{ConfigurationError, entries, required};

/// What a controller backup's SIO.cfg says about connections to other machines.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SioConfiguration {
    /// Physical channels and transmission protocols with their type, `LAN1` and `TCP/IP`.
    pub channels: Vec<(String, String)>,
    /// Remote addresses by the name of their protocol instance.
    pub remotes: Vec<(String, String)>,
}

impl SioConfiguration {
    /// Reads the text of a SIO.cfg. Sockets of programs need nothing of it; it is read so that a backup loads as
    /// a whole and its mistakes are told.
    ///
    /// # Errors
    /// All entries that cannot be understood.
    pub fn parse(text: &str) -> Result<Self, Vec<ConfigurationError>> {
        let mut read = Self::default();
        let mut errors = Vec::new();
        for entry in entries(text, "SIO")? {
            let field = |key: &str| entry.fields.get(key).cloned().unwrap_or_default();
            let name = match required(&entry, "Name") {
                Ok(name) => name.to_owned(),
                Err(_) if !entry.section.starts_with("COM_") => continue,
                Err(message) => {
                    errors.push(ConfigurationError {
                        line: entry.line,
                        message,
                    });
                    continue;
                }
            };
            if entry.section.starts_with("COM_") {
                read.channels.push((name.clone(), field("type")));
            }
            for key in ["remoteadress", "remoteaddress"] {
                if entry.fields.contains_key(key) {
                    read.remotes.push((name.clone(), field(key)));
                }
            }
        }
        if errors.is_empty() {
            Ok(read)
        } else {
            Err(errors)
        }
    }
}
