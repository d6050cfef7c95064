const link = document.createElement("a");
link.href = URL.createObjectURL(new Blob([file.data.text[0]], {type: "text/plain"}));
link.download = file.data.name[0];
link.click();
URL.revokeObjectURL(link.href);
