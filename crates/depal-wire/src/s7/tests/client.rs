//! A client against the offered block, without sockets.

use crate::s7::*;

/// Carries bytes to and fro until the client is done.
fn done(client: &mut BlockClient, server: &mut BlockServer, block: &mut DataBlock) -> BlockDone {
    for _ in 0..200 {
        if let Some(done) = client.poll().expect("good answers") {
            return done;
        }
        server.push(&client.poll_output().unwrap_or_default());
        while let Some(served) = server.poll(block).expect("good requests") {
            client.push(&served.frame);
        }
    }
    panic!("never done with {}", client.asked());
}

fn connected(db: u16) -> (BlockClient, BlockServer, DataBlock) {
    let (mut client, mut server) = (BlockClient::new(db, 0, 1), BlockServer::new());
    let mut block = DataBlock::new();
    client.connect();
    let done = done(&mut client, &mut server, &mut block);
    assert_eq!(done, BlockDone::Connected);
    assert!(client.is_idle());
    (client, server, block)
}

/// More than one telegram holds goes and comes in parts.
#[test]
fn long_transfers_are_whole() {
    let (mut client, mut server, mut block) = connected(1);
    let bytes: Vec<u8> = (0..2000u32).map(|n| (n * 7) as u8).collect();
    client.write(300, bytes.clone());
    let written = done(&mut client, &mut server, &mut block);
    assert_eq!(written, BlockDone::Written);
    assert_eq!(block.bytes(300, 2000), Some(bytes.as_slice()));
    client.read(299, 2001);
    let BlockDone::Read(read) = done(&mut client, &mut server, &mut block) else {
        panic!("a read");
    };
    assert_eq!((read[0], &read[1..]), (0, bytes.as_slice()));
}

#[test]
fn a_block_that_is_not_there_is_named() {
    let (mut client, mut server, mut block) = connected(7);
    client.read(10, 4);
    server.push(&client.poll_output().expect("a question"));
    let served = server.poll(&mut block).expect("good").expect("an answer");
    client.push(&served.frame);
    assert!(matches!(
        client.poll(),
        Err(BlockClientError::Item {
            db: 7,
            first: 10,
            last: 13,
            ..
        })
    ));
}

/// The same answer twice: the second is of no question.
#[test]
fn late_answers_are_passed_over() {
    let (mut client, mut server, mut block) = connected(1);
    client.read(0, 2);
    server.push(&client.poll_output().expect("a question"));
    let served = server.poll(&mut block).expect("good").expect("an answer");
    client.push(&served.frame);
    client.push(&served.frame);
    assert_eq!(client.poll(), Ok(Some(BlockDone::Read(vec![0, 0]))));
    client.write(0, vec![1, 2]);
    let written = done(&mut client, &mut server, &mut block);
    assert_eq!(written, BlockDone::Written);
}
