MODULE größe
  ! 5 °C für €
  VAR num länge;
ENDMODULE
