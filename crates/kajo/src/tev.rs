//! A picture in the making, shown by the viewer `tev` over the network.
//!
//! A packet is its length in bytes (32 bits, itself included), a byte for its kind, and its content; numbers are
//! little-endian, names end with a zero. Two kinds are enough:
//!
//! * 4, create an image: take the focus (a byte), name, width, height and number of channels (32 bits each), names of
//!   the channels
//! * 6, update an image: take the focus, name, number and names of channels, x, y, width, height of the
//!   rectangle, for each channel the offset of its first value and the distance from one to the next (64 bits each,
//!   counted in values), the values
//!
//! [Müller, tev, `Ipc.h`]

use std::io::{self, ErrorKind, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use kajo_image::Image;

const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE: u8 = 6;

/// The port that tev listens on.
const PORT: u16 = 14158;

/// How long a viewer may keep us waiting.
const PATIENCE: Duration = Duration::from_secs(3);

/// Interval between two checks whether to stop waiting.
const LOOK: Duration = Duration::from_millis(50);

/// Values in one packet, about.
const PACKET_VALUES: usize = 1 << 20;

/// A connection to a viewer, which shows one image.
#[derive(Debug)]
pub struct Tev {
    stream: TcpStream,
    name: String,
    size: Option<[u32; 2]>,
}

impl Tev {
    /// Connects to a viewer.
    ///
    /// * `address`: `host:port`, or a host alone
    /// * `name`: what the image is called there
    ///
    /// # Errors
    /// When nobody answers within three seconds.
    pub fn connect(address: &str, name: &str) -> io::Result<Tev> {
        let addresses = address.to_socket_addrs().or_else(|_| (address, PORT).to_socket_addrs())?;
        let mut result = Err(io::Error::new(ErrorKind::NotFound, "no such host"));
        for address in addresses {
            result = TcpStream::connect_timeout(&address, PATIENCE);
            if result.is_ok() {
                break;
            }
        }
        let stream = result?;
        stream.set_write_timeout(Some(LOOK))?;
        // A zero would end the name.
        Ok(Tev { stream, name: name.replace('\0', ""), size: None })
    }

    /// Shows a picture in place of the last one.
    ///
    /// * `stop`: whether to wait no longer for a viewer that reads nothing
    ///
    /// # Errors
    /// When the viewer has gone, reads nothing for three seconds, or reads nothing when it is time to stop.
    pub fn show(&mut self, image: &Image, stop: &dyn Fn() -> bool) -> io::Result<()> {
        let size = [image.width(), image.height()];
        let channels: &[&str] = if image.channels() == 1 { &["Y"] } else { &["R", "G", "B"] };
        if self.size != Some(size) {
            self.send(self.create(size, channels), stop)?;
            self.size = Some(size);
        }
        let per_row = size[0] as usize * image.channels();
        let rows = (PACKET_VALUES / per_row.max(1)).max(1);
        for (i, values) in image.data().chunks(rows * per_row).enumerate() {
            let packet = self.update((i * rows) as u32, size[0], channels, image.channels(), values);
            self.send(packet, stop)?;
        }
        Ok(())
    }

    fn create(&self, size: [u32; 2], channels: &[&str]) -> Vec<u8> {
        let mut packet = self.packet(CREATE_IMAGE);
        for number in [size[0], size[1], channels.len() as u32] {
            packet.extend(number.to_le_bytes());
        }
        channels.iter().for_each(|name| put_name(&mut packet, name));
        packet
    }

    /// Whole rows from `y` on.
    fn update(&self, y: u32, width: u32, channels: &[&str], stride: usize, values: &[f32]) -> Vec<u8> {
        let mut packet = self.packet(UPDATE_IMAGE);
        packet.extend((channels.len() as u32).to_le_bytes());
        channels.iter().for_each(|name| put_name(&mut packet, name));
        let height = values.len() / (width as usize * stride);
        for number in [0, y, width, height as u32] {
            packet.extend(number.to_le_bytes());
        }
        (0..channels.len() as u64).for_each(|offset| packet.extend(offset.to_le_bytes()));
        channels.iter().for_each(|_| packet.extend((stride as u64).to_le_bytes()));
        // The values end with the last one of the last channel.
        let unused = stride - channels.len();
        values[..values.len() - unused].iter().for_each(|value| packet.extend(value.to_le_bytes()));
        packet
    }

    /// The beginning of a packet, with room for its length.
    fn packet(&self, kind: u8) -> Vec<u8> {
        let mut packet = vec![0, 0, 0, 0, kind, 0];
        put_name(&mut packet, &self.name);
        packet
    }

    fn send(&self, mut packet: Vec<u8>, stop: &dyn Fn() -> bool) -> io::Result<()> {
        let length = (packet.len() as u32).to_le_bytes();
        packet[..4].copy_from_slice(&length);
        let mut rest = &packet[..];
        let mut last_read = Instant::now();
        while !rest.is_empty() {
            match (&self.stream).write(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(n) => {
                    rest = &rest[n..];
                    last_read = Instant::now();
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    if stop() || last_read.elapsed() >= PATIENCE {
                        return Err(ErrorKind::TimedOut.into());
                    }
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

fn put_name(packet: &mut Vec<u8>, name: &str) {
    packet.extend(name.as_bytes());
    packet.push(0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::net::TcpListener;
    use std::thread;

    /// Reads little-endian numbers and names one after the other.
    struct Reader<'a>(&'a [u8]);

    impl Reader<'_> {
        fn take<const N: usize>(&mut self) -> [u8; N] {
            let (head, tail) = self.0.split_first_chunk().expect("more bytes");
            self.0 = tail;
            *head
        }

        fn u32(&mut self) -> u32 {
            u32::from_le_bytes(self.take())
        }

        fn u64(&mut self) -> u64 {
            u64::from_le_bytes(self.take())
        }

        fn name(&mut self) -> String {
            let end = self.0.iter().position(|&b| b == 0).expect("a zero");
            let name = String::from_utf8(self.0[..end].to_vec()).expect("UTF-8");
            self.0 = &self.0[end + 1..];
            name
        }
    }

    /// What a viewer would show after all that was sent.
    fn viewer(sent: &[u8]) -> (String, Image) {
        let mut image: Option<(String, Image)> = None;
        let mut rest = sent;
        while !rest.is_empty() {
            let length = Reader(rest).u32() as usize;
            let mut packet = Reader(&rest[4..length]);
            rest = &rest[length..];
            let [kind, focus] = packet.take();
            assert_eq!(focus, 0);
            let name = packet.name();
            if kind == CREATE_IMAGE {
                let [width, height, n] = [(); 3].map(|()| packet.u32());
                (0..n).for_each(|c| assert_eq!(packet.name(), ["R", "G", "B"][c as usize]));
                image = Some((name, Image::new(width, height, n as usize).expect("an image")));
            } else {
                assert_eq!(kind, UPDATE_IMAGE);
                let (known, image) = image.as_mut().expect("created before");
                assert_eq!(*known, name);
                let n = packet.u32();
                (0..n).for_each(|c| assert_eq!(packet.name(), ["R", "G", "B"][c as usize]));
                let [x0, y0, width, height] = [(); 4].map(|()| packet.u32());
                let offsets: Vec<u64> = (0..n).map(|_| packet.u64()).collect();
                let strides: Vec<u64> = (0..n).map(|_| packet.u64()).collect();
                let values: Vec<f32> =
                    packet.0.chunks(4).map(|v| f32::from_le_bytes(v.try_into().expect("four"))).collect();
                let last = (0..n as usize)
                    .map(|c| offsets[c] + u64::from(width * height - 1) * strides[c] + 1)
                    .max();
                assert_eq!(values.len() as u64, last.expect("channels"));
                for i in 0..width * height {
                    for c in 0..n as usize {
                        let value = values[(offsets[c] + u64::from(i) * strides[c]) as usize];
                        image.pixel_mut(x0 + i % width, y0 + i / width)[c] = value;
                    }
                }
                packet.0 = &[];
            }
            assert!(packet.0.is_empty());
        }
        image.expect("something was sent")
    }

    #[test]
    fn a_viewer_sees_the_last_picture() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let server = thread::spawn(move || {
            let mut sent = Vec::new();
            listener.accept().unwrap().0.read_to_end(&mut sent).unwrap();
            sent
        });
        let picture = |shift: f32| Image::from_fn(700, 601, |x, y| [x as f32, y as f32, shift]).unwrap();
        let mut tev = Tev::connect(&address, "a ball").unwrap();
        tev.show(&picture(1.0), &|| false).unwrap();
        tev.show(&picture(2.5), &|| false).unwrap();
        drop(tev);
        let (name, shown) = viewer(&server.join().unwrap());
        assert_eq!(name, "a ball");
        assert!(shown == picture(2.5));
    }

    #[test]
    fn a_viewer_that_reads_nothing_is_not_waited_for_when_it_is_time_to_stop() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let mut tev = Tev::connect(&listener.local_addr().unwrap().to_string(), "x").unwrap();
        let _connection = listener.accept().unwrap();
        // More than any system keeps for a reader.
        let image = Image::filled(4000, 4000, &[1.0; 3]).unwrap();
        let asked = std::cell::Cell::new(0);
        let stop = || asked.replace(asked.get() + 1) > 0;
        assert!(tev.show(&image, &stop).is_err());
        assert_eq!(asked.get(), 2, "it stops when it is told to");
    }

    #[test]
    fn nobody_there_is_an_error() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let address = listener.local_addr().unwrap().to_string();
        drop(listener);
        assert!(Tev::connect(&address, "x").is_err());
    }
}
