use crate::harness::*;

const FILE: &str = "VAR iodev f;\nVAR rawbytes raw;\nVAR num bytes{3} := [65,66,255];\nVAR num n;";

fn lines(statements: &str) -> (Vec<String>, Told) {
    let told = run_in(statements, FILE, &[], |spec| {
        let text = b"first line\r\n12.5\nlast".to_vec();
        spec.files.insert("data/in.txt".to_owned(), text);
    });
    (told.lines.clone(), told)
}

#[test]
fn what_is_written_is_read_again() {
    let (lines, told) = lines(
        "Open \"HOME:\"\\File:=\"log/out.txt\",f\\Write;\nWrite f,\"n=\"\\Num:=2.5;\nWrite f,\"no line end;\"\\NoNewLine;\nWrite f,\"pos \"\\Pos:=[1,2,3];\nClose f;\nOpen \"HOME:/log/out.txt\",f\\Append;\nWrite f,\"more\";\nClose f;\nOpen \"HOME:/log\"\\File:=\"out.txt\",f\\Read;\nTPWrite ReadStr(f);\nTPWrite ReadStr(f);\nTPWrite ReadStr(f);\nTPWrite ReadStr(f);\nIF ReadStr(f)=EOF TPWrite \"at the end\";\nRewind f;\nTPWrite ReadStr(f\\Delim:=\"=\");\nClose f;\nTPWrite NumToStr(FileSize(\"HOME:log/out.txt\"),0);",
    );
    told.finished();
    assert_eq!(
        lines,
        [
            "n=2.5",
            "no line end;pos [1,2,3]",
            "more",
            "EOF",
            "at the end",
            "n",
            "35"
        ]
    );
}

#[test]
fn numbers_bytes_and_raw_data() {
    let (lines, told) = lines(
        "Open \"HOME:/data/in.txt\",f\\Read;\nTPWrite ReadStr(f\\RemoveCR);\nTPWrite NumToStr(ReadNum(f),1);\nTPWrite ReadStrBin(f,2);\nTPWrite NumToStr(ReadBin(f),0);\nn := ReadBin(f);\nIF ReadBin(f)=EOF_BIN TPWrite \"end\";\nIF ReadNum(f)=EOF_NUM TPWrite \"end\";\nClose f;\nOpen \"HOME:/b.bin\",f\\Write\\Bin;\nWriteBin f,bytes,3;\nWriteStrBin f,\"x\\0D\";\nPackRawBytes 258,raw,1\\IntX:=INT;\nWriteRawBytes f,raw;\nClose f;\nOpen \"HOME:/b.bin\",f\\Read\\Bin;\nClearRawBytes raw;\nReadRawBytes f,raw;\nTPWrite NumToStr(RawBytesLen(raw),0);\nClose f;",
    );
    let told = told.finished();
    assert_eq!(
        lines,
        ["first line", "12.5", "la", "115", "end", "end", "7"]
    );
    assert_eq!(told.files["b.bin"], [65, 66, 255, b'x', 13, 2, 1]);
}

/// No path leads out of the folder, and devices that are not there are refused, at the instruction's line.
#[test]
fn paths_stay_in_the_folder() {
    for path in [
        "HOME:/../secret",
        "../secret",
        "HOME:/data/../../secret",
        "/data/../../secret",
        "hd0a:/secret",
        "com1:",
        "HOME:\\\\..\\\\..\\\\secret",
        "TEMP:/../in.txt",
    ] {
        let (_, told) = lines(&format!("TPWrite \"before\";\nOpen \"{path}\",f\\Write;"));
        assert_eq!(told.failure(), ("ERR_FILEOPEN".to_owned(), 3), "{path}");
        assert_eq!(told.files.len(), 1, "{path}");
    }
    let (_, told) = lines("RemoveFile \"HOME:/../data/in.txt\";");
    assert_eq!(told.failure(), ("ERR_FILEACC".to_owned(), 2));
    // Inside, dots are fine.
    let (read, told) =
        lines("Open \"HOME:/x/../data/./in.txt\",f\\Read;\nTPWrite ReadStr(f\\RemoveCR);");
    told.finished();
    assert_eq!(read, ["first line"]);
}

#[test]
fn wrong_uses_are_errors_that_can_be_handled() {
    for (statements, name) in [
        ("Open \"HOME:/none.txt\",f\\Read;", "ERR_FILEOPEN"),
        ("TPWrite ReadStr(f);", "ERR_FILEACC"),
        (
            "Open \"HOME:/o\",f\\Write;TPWrite ReadStr(f);",
            "ERR_FILEACC",
        ),
        (
            "Open \"HOME:/data/in.txt\",f\\Read;n:=ReadNum(f);",
            "ERR_RCVDATA",
        ),
        ("TPWrite NumToStr(FileSize(\"none\"),0);", "ERR_FILNOTFND"),
        (
            "CopyFile \"HOME:/data/in.txt\",\"HOME:/data/in.txt\";",
            "ERR_FILEEXIST",
        ),
    ] {
        let (_, told) = lines(statements);
        assert_eq!(told.failure(), (name.to_owned(), 2), "{statements}");
    }
}

#[test]
fn folders_and_copies() {
    let (lines, told) = lines(
        "IF IsFile(\"HOME:/data\") TPWrite \"there\";\nIF NOT IsFile(\"HOME:/data\"\\RegFile) TPWrite \"no file\";\nMakeDir \"HOME:/new\";\nIF IsFile(\"HOME:/new\"\\Directory) TPWrite \"made\";\nCopyFile \"HOME:/data/in.txt\",\"HOME:/new/copy.txt\";\nRenameFile \"HOME:/new/copy.txt\",\"HOME:/new/name.txt\";\nRemoveFile \"HOME:/data/in.txt\";\nIF FSSize(\"HOME:\"\\Free)<FSSize(\"HOME:\"\\Total) TPWrite \"used\";",
    );
    let told = told.finished();
    assert_eq!(lines, ["there", "no file", "made", "used"]);
    let names: Vec<_> = told.files.keys().collect();
    assert_eq!(names, ["new/", "new/name.txt"]);
}
