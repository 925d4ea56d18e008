// Said by the server when it ends: the page stays readable, and does not knock at a closed door.
window.zerorevEnded = () => {
  window.socket?.io?.reconnection(false);
  // hidden, not taken away: the lost connection still sets its attributes
  document.getElementById("popup")?.style.setProperty("display", "none", "important");
  const note = document.createElement("div");
  note.className = "zr-ended";
  note.setAttribute("role", "alert");
  note.dataset.testid = "ended";
  note.textContent = "The app has ended. What is on this page can still be read; zerorev view starts it again.";
  document.body.append(note);
};
