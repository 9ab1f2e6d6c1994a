//! How a worker process is talked to: messages over its standard input and output.
//!
//! | bytes | what |
//! |---|---|
//! | 4, n | length of a JSON object, and the object |
//! | 8, n | length of bytes that go with it, and these |
//!
//! Numbers are little-endian. A worker is sent [`Request`]s and answers each with a [`Response`]:
//!
//! | request | bytes with it | response | bytes with it |
//! |---|---|---|---|
//! | `{"do":"open","plan":TEXT}` | a bundle, or none | `{"ok":true,"threads":N}` | |
//! | `{"do":"unit","stage":S,"unit":U}` | the beginning of the stage; none for the first |
//! `{"ok":true,"samples":N,"rays":N,"seconds":X}` | the part |
//!
//! What fails is answered with `{"ok":false,"kind":K,"message":TEXT}`, where `input` is for what stays wrong
//! everywhere and `unit` for what went wrong with this one. The end of its input ends a worker at once.

use std::io::{self, ErrorKind, Read, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Bytes of the longest object.
const LONGEST: u32 = 128 << 20;

/// What a worker is asked to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase")]
pub enum Request {
    /// Get ready for units of a plan.
    Open {
        /// The text of `plan.json`.
        plan: String,
    },
    /// Render a unit of the plan that was opened last.
    Unit {
        /// The stage.
        stage: u32,
        /// The unit.
        unit: u64,
    },
}

/// What a worker answers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Whether it is done.
    pub ok: bool,
    /// What kind of failure it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<FailureKind>,
    /// What went wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Threads that render.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub threads: u64,
    /// Samples that were taken.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub samples: u64,
    /// Rays that were cast.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rays: u64,
    /// How long it took.
    #[serde(default)]
    pub seconds: f64,
}

/// Whose fault a failure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FailureKind {
    /// The plan or the request is wrong: no other worker will do better.
    Input,
    /// The unit could not be rendered here.
    Unit,
}

impl Response {
    /// A failure.
    pub fn failed(kind: FailureKind, message: impl Into<String>) -> Response {
        Response { kind: Some(kind), message: Some(message.into()), ..Response::default() }
    }
}

fn is_zero(n: &u64) -> bool {
    *n == 0
}

/// Writes a message.
///
/// # Errors
/// Those of `out`.
pub fn send<T: Serialize>(out: &mut dyn Write, message: &T, bytes: &[u8]) -> io::Result<()> {
    let text = serde_json::to_vec(message)?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(&text)?;
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(bytes)?;
    out.flush()
}

/// Reads a message; `None` at the end of the input.
///
/// # Errors
/// Those of `input`; `InvalidData` for what is no message, and `UnexpectedEof` in the middle of one.
pub fn receive<T: DeserializeOwned>(input: &mut dyn Read) -> io::Result<Option<(T, Vec<u8>)>> {
    let mut length = [0; 4];
    loop {
        match input.read(&mut length[..1]) {
            Ok(0) => return Ok(None),
            Ok(_) => break,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    input.read_exact(&mut length[1..])?;
    let length = u32::from_le_bytes(length);
    if length > LONGEST {
        return Err(ErrorKind::InvalidData.into());
    }
    let text = exactly(input, length.into())?;
    let message = serde_json::from_slice(&text)?;
    let mut length = [0; 8];
    input.read_exact(&mut length)?;
    Ok(Some((message, exactly(input, u64::from_le_bytes(length))?)))
}

/// So many bytes, for which room is made as they come.
fn exactly(input: &mut dyn Read, length: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == length { Ok(bytes) } else { Err(ErrorKind::UnexpectedEof.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_back() {
        let request = Request::Unit { stage: 2, unit: 7 };
        let mut bytes = Vec::new();
        send(&mut bytes, &request, b"abc").unwrap();
        send(&mut bytes, &Response::failed(FailureKind::Unit, "no"), b"").unwrap();
        let mut input = &bytes[..];
        assert_eq!(receive(&mut input).unwrap(), Some((request, b"abc".to_vec())));
        let (response, none): (Response, Vec<u8>) = receive(&mut input).unwrap().unwrap();
        assert_eq!((response.kind, none.len()), (Some(FailureKind::Unit), 0));
        assert!(receive::<Request>(&mut input).unwrap().is_none());
        for cut in 1..bytes.len().min(40) {
            assert!(receive::<Request>(&mut &bytes[..cut]).is_err(), "{cut}");
        }
        assert!(receive::<Request>(&mut &[0xFF; 40][..]).is_err());
        let text = br#"{"do":"unit","stage":0,"unit":1}"#;
        let endless = [&(text.len() as u32).to_le_bytes()[..], text, &u64::MAX.to_le_bytes()].concat();
        assert!(receive::<Request>(&mut &endless[..]).is_err());
    }
}
