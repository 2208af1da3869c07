MODULE m PROC main() x := - - + - 0;E m VAR num a{101000,000Dñññ€
L); z := = a.b; ENDPROC ENDMODULE