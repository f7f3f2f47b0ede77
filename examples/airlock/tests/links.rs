//! The links of docs/your-robot.md: one for each kind of HAL.

use firmware::adapters::{AsyncLink, IoLink, PacketLink, PacketRadio, Stream06, StreamNb};
use firmware::hardware::Link;

/// `embedded-io` 0.7.
fn over_embedded_io<RX, TX>(rx: RX, tx: TX) -> impl Link
where
    RX: embedded_io::Read + embedded_io::ReadReady,
    TX: embedded_io::Write + embedded_io::WriteReady,
{
    IoLink::new(rx, tx)
}

/// `embedded-io` 0.6.
fn over_embedded_io_06<RX, TX>(rx: RX, tx: TX) -> impl Link
where
    RX: embedded_io_06::Read + embedded_io_06::ReadReady,
    TX: embedded_io_06::Write + embedded_io_06::WriteReady,
{
    IoLink::new(Stream06(rx), Stream06(tx))
}

/// `embedded-hal-nb` 1.0.
fn over_embedded_hal_nb<RX, TX>(rx: RX, tx: TX) -> impl Link
where
    RX: embedded_hal_nb::serial::Read,
    TX: embedded_hal_nb::serial::Write,
{
    IoLink::new(StreamNb::new(rx), StreamNb::new(tx))
}

/// `embedded-io-async` 0.7: the link of the robot is `&LINK`.
static LINK: AsyncLink = AsyncLink::new();

/// A task of the executor, with the receiving half of a port.
async fn listen(rx: impl embedded_io_async::Read) -> ! {
    LINK.receive_from(rx).await
}

/// A task of the executor, with the sending half.
async fn speak(tx: impl embedded_io_async::Write) -> ! {
    LINK.send_to(tx).await
}

/// The driver of a radio, with the calls that most have: neither waits.
struct Radio<D>(D);

trait Driver {
    fn broadcast(&mut self, bytes: &[u8]) -> Result<(), ()>;
    fn next_packet(&mut self) -> Option<&[u8]>;
}

impl<D: Driver> PacketRadio for Radio<D> {
    type Error = ();

    fn send(&mut self, packet: &[u8]) -> Result<(), ()> {
        self.0.broadcast(packet)
    }
    fn receive(&mut self, packet: &mut [u8]) -> Option<usize> {
        let next = self.0.next_packet()?;
        packet.iter_mut().zip(next).for_each(|(to, &byte)| *to = byte);
        Some(next.len())
    }
}

fn over_packets(driver: impl Driver) -> impl Link {
    PacketLink::new(Radio(driver))
}

/// A driver that has one packet and takes none.
struct Deaf;

impl Driver for Deaf {
    fn broadcast(&mut self, _: &[u8]) -> Result<(), ()> {
        Err(())
    }
    fn next_packet(&mut self) -> Option<&[u8]> {
        Some(&[0; 200])
    }
}

#[test]
fn a_radio_that_takes_nothing_is_a_link_that_refuses() {
    let mut link = over_packets(Deaf);
    assert!(!link.send(&[0, 1, 0]));
    assert_eq!(link.receive_packet(&mut [0; 127]), Some(0), "the packet is longer than a frame");
}

#[test]
fn streams_and_tasks_make_links() {
    let (mut empty, mut wire): (&[u8], [u8; 8]) = (&[], [0; 8]);
    let mut link = over_embedded_io(&mut empty, wire.as_mut_slice());
    assert!(link.send(&[0, 1, 0]) && link.receive().is_none());
    let (received, mut sent): (&[u8], [u8; 8]) = (&[], [0; 8]);
    drop((listen(received), speak(sent.as_mut_slice())));
    let _others = (over_embedded_io_06::<NoPort, NoPort>, over_embedded_hal_nb::<NoPort, NoPort>);
    assert!((&LINK).send(&[0, 1, 0]));
}

/// A port that is never there.
struct NoPort;

impl embedded_io_06::ErrorType for NoPort {
    type Error = embedded_io_06::ErrorKind;
}
impl embedded_io_06::Read for NoPort {
    fn read(&mut self, _: &mut [u8]) -> Result<usize, Self::Error> {
        Ok(0)
    }
}
impl embedded_io_06::ReadReady for NoPort {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(false)
    }
}
impl embedded_io_06::Write for NoPort {
    fn write(&mut self, _: &[u8]) -> Result<usize, Self::Error> {
        Ok(0)
    }
    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}
impl embedded_io_06::WriteReady for NoPort {
    fn write_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(false)
    }
}
impl embedded_hal_nb::serial::ErrorType for NoPort {
    type Error = embedded_hal_nb::serial::ErrorKind;
}
impl embedded_hal_nb::serial::Read for NoPort {
    fn read(&mut self) -> embedded_hal_nb::nb::Result<u8, Self::Error> {
        Err(embedded_hal_nb::nb::Error::WouldBlock)
    }
}
impl embedded_hal_nb::serial::Write for NoPort {
    fn write(&mut self, _: u8) -> embedded_hal_nb::nb::Result<(), Self::Error> {
        Err(embedded_hal_nb::nb::Error::WouldBlock)
    }
    fn flush(&mut self) -> embedded_hal_nb::nb::Result<(), Self::Error> {
        Ok(())
    }
}
